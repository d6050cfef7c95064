// Frames with the page to drag along a front: they are as high as it is, and have the site's colours.
const frames = () => [...document.querySelectorAll("iframe")];
const tellTheme = (frame) => frame.contentWindow?.postMessage({ quietarm: { theme: document.body.dataset.theme ?? "auto" } }, "*");
addEventListener("message", ({ data, source }) => {
  const frame = frames().find(({ contentWindow }) => contentWindow === source);
  const height = data?.quietarm?.height;
  if (!frame || !(height > 0) || frame.style.height === `${height}px`) return;
  frame.style.height = `${height}px`;
  tellTheme(frame);
});
addEventListener("DOMContentLoaded", () => {
  frames().forEach(tellTheme);
  new MutationObserver(() => frames().forEach(tellTheme)).observe(document.body, { attributes: true, attributeFilter: ["data-theme"] });
});
