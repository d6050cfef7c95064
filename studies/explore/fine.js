// With the shift key a slider's handle goes a tenth as far as the pointer: from where the key was pressed until the button is released.
const tenth = 0.1;
let fine = null;
let held = null;
let last = 0;
const sliders = () => columns.flatMap((column) => column.children.map((row) => row.children[1]));
addEventListener("mousedown", (event) => {
    const path = event.composedPath();
    const views = sliders().map((slider) => Bokeh.index.find_one(slider));
    held = views.find((view) => view && path.includes(view.el)) ?? null;
    fine = null;
    last = event.clientX;
}, true);
addEventListener("mousemove", (event) => {
    if (!held || !event.buttons) return;
    const across = event.clientX - last;
    last = event.clientX;
    if (!event.shiftKey && fine === null) return;
    event.stopImmediatePropagation();
    const {start, end, step, value} = held.model;
    fine = (fine ?? value) + tenth * across / held.el.getBoundingClientRect().width * (end - start);
    const rounded = Math.round((Math.min(Math.max(fine, start), end) - start) / step) * step + start;
    if (rounded !== value) held.model.value = Number(rounded.toPrecision(12));
}, true);
addEventListener("mouseup", () => { held = fine = null; }, true);
