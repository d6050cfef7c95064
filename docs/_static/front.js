// Frames with the page to drag along a front: they are as high as it is, have the site's colours, and get the arrow keys that this page has no use for.
const frames = () => [...document.querySelectorAll("iframe")];
const tell = (frame, message) => frame.contentWindow?.postMessage({ quietarm: message }, "*");
const tellTheme = (frame) => tell(frame, { theme: document.body.dataset.theme ?? "auto" });
addEventListener("message", ({ data, source }) => {
  const frame = frames().find(({ contentWindow }) => contentWindow === source);
  const height = data?.quietarm?.height;
  if (!frame || !(height > 0) || frame.style.height === `${height}px`) return;
  frame.style.height = `${height}px`;
  tellTheme(frame);
});
addEventListener("DOMContentLoaded", () => {
  frames().forEach(tellTheme);
  addSkip();
  new MutationObserver(() => frames().forEach(tellTheme)).observe(document.body, { attributes: true, attributeFilter: ["data-theme"] });
});

// A link at the page's start by which the keyboard is at the first frame's ring, without a press of Tab for every link of the side bar.
const addSkip = () => {
  const [frame] = frames();
  const start = document.querySelector(".skip-to-content");
  if (!frame || !start) return;
  frame.id ||= "front-to-drag";
  const link = Object.assign(document.createElement("a"), { href: `#${frame.id}`, className: start.className, textContent: "Skip to the front to drag" });
  link.addEventListener("click", (event) => {
    event.preventDefault();
    frame.scrollIntoView();
    frame.focus({ preventScroll: true });
    tell(frame, { focus: true });
  });
  start.after(link);
};

// Left and right go to the frame that is in sight, or under the mouse; up and down scroll this page, as ever.
const CHART = 300; // pixels at the top of a frame in which its front is
const inSight = (frame) => {
  const { top } = frame.getBoundingClientRect();
  return frame.matches(":hover") || (top > -CHART / 2 && top + CHART / 2 < innerHeight);
};
addEventListener("keydown", (event) => {
  const { key, target } = event;
  if (key !== "ArrowLeft" && key !== "ArrowRight") return;
  if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey || event.shiftKey) return;
  const needed = target.closest?.("input, select, textarea, pre, [contenteditable], [role=tab], [tabindex]");
  const frame = needed ? undefined : frames().find(inSight);
  if (!frame || document.scrollingElement.scrollWidth > innerWidth) return;
  event.preventDefault();
  tell(frame, { key });
});
