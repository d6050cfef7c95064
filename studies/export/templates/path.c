    double t, {{ variables | join(", ") }};

    if (time <= 0.0 || time >= {{ duration }}) {
        *angle = time <= 0.0 ? {{ start }} : {{ target }};
        *speed = 0.0;
        *acceleration = 0.0;
        return;
    }
    t = time / {{ duration }};
{% for line in lines %}
    {{ line }}
{% endfor %}
