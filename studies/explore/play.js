const stillness = matchMedia("(prefers-reduced-motion: reduce)");
const play = () => {
    const {xs, ys, colour, width, frames, words} = film.data;
    const now = Math.floor(performance.now() / 1000 * rate) % (frames[0] + rate);
    const at = stillness.matches ? frames[0] - 1 : Math.min(now, frames[0] - 1);
    const current = (all) => {
        const points = all.length / frames[0];
        return all.slice(at * points, (at + 1) * points);
    };
    shown.data = {xs: xs.map(current), ys: ys.map(current), colour, width};
    title.text = `${words[0]}, t = ${(at / rate).toFixed(2)} s`;
};
setInterval(play, 1000 / rate);
