// With the shift key a slider's handle goes a tenth as far as the pointer: from where the key was pressed until the button is released.
const tenth = 0.1;
let fine = null;
let held = null;
const sliders = () => columns.flatMap((column) => column.children.map((row) => row.children[1]));
addEventListener("pointerdown", (event) => {
    const path = event.composedPath();
    const views = sliders().map((slider) => Bokeh.index.find_one(slider));
    held = views.find((view) => view && path.includes(view.el)) ?? null;
    fine = null;
}, true);
addEventListener("pointermove", (event) => {
    if (!held || !event.buttons || !(event.shiftKey || fine)) return;
    event.stopImmediatePropagation();
    const {start, end, step, value} = held.model;
    const width = held.el.getBoundingClientRect().width;
    fine ??= {x: event.clientX, value};
    fine.value += tenth * (event.clientX - fine.x) / width * (end - start);
    fine.x = event.clientX;
    const rounded = Math.round((Math.min(Math.max(fine.value, start), end) - start) / step) * step + start;
    if (rounded !== value) held.model.value = Number(rounded.toPrecision(12));
}, true);
addEventListener("pointerup", () => { held = fine = null; }, true);
