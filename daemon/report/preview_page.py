"""How preview.html looks and moves: its style and its script, which speak to nobody but the page itself."""

from __future__ import annotations

STYLE = """
:root { color-scheme: light dark; --desk: #f3f2f0; --card: #fff; --words: #22262b; --quiet: #6a7078; --rim: #dcdad6;
  --accent: #b5500b; --warn: #8a1c1c; --warn-desk: #fdeaea; }
@media (prefers-color-scheme: dark) { :root { --desk: #17191c; --card: #212428; --words: #e8e6e3; --quiet: #9aa1a9;
  --rim: #363b41; --accent: #ff9d4d; --warn: #ffb4b4; --warn-desk: #3d2020; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--desk); color: var(--words); font: 16px/1.45 system-ui, sans-serif; }
main { max-width: 1180px; margin: 0 auto; padding: 16px; }
h1 { font-size: 1.35rem; margin: 0 0 2px; overflow-wrap: anywhere; }
h2 { font-size: 1rem; margin: 0 0 8px; }
p { margin: 0 0 8px; }
.quiet { color: var(--quiet); }
.both { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 420px), 1fr)); gap: 16px; }
section { background: var(--card); border: 1px solid var(--rim); border-radius: 10px; padding: 14px; margin-top: 16px;
  min-width: 0; }
svg { display: block; width: 100%; height: auto; max-height: 74vh; background: #fff; border-radius: 4px; }
.facts { display: flex; flex-wrap: wrap; gap: 6px 26px; margin: 12px 0 0; padding: 0; }
.facts div { min-width: 92px; }
.facts dt { color: var(--quiet); font-size: .82rem; }
.facts dd { margin: 0; font-size: 1.1rem; font-weight: 600; font-variant-numeric: tabular-nums; }
.row { display: flex; flex-wrap: wrap; align-items: center; gap: 10px 14px; margin-top: 10px; }
label { display: flex; align-items: center; gap: 8px; min-height: 40px; }
button, select { min-height: 42px; font: inherit; padding: 0 16px; border-radius: 8px; border: 1px solid var(--rim);
  background: var(--card); color: inherit; }
button { background: var(--accent); border-color: var(--accent); color: var(--card); font-weight: 600;
  min-width: 96px; }
input[type=range] { flex: 1 1 160px; min-width: 120px; accent-color: var(--accent); height: 32px; }
input[type=checkbox] { width: 20px; height: 20px; accent-color: var(--accent); }
#clock { font-variant-numeric: tabular-nums; }
.warnings { background: var(--warn-desk); color: var(--warn); }
.warnings ul, .steps { margin: 0; padding-left: 20px; }
code { background: var(--desk); border: 1px solid var(--rim); border-radius: 5px; padding: 2px 6px; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
td, th { text-align: left; padding: 5px 8px 5px 0; border-bottom: 1px solid var(--rim); }
.swatch { display: inline-block; width: 14px; height: 14px; border-radius: 50%; vertical-align: -2px; margin-right: 8px;
  border: 1px solid var(--rim); }
.off { display: none; }
"""

SCRIPT = """
'use strict';
const sheet = document.getElementById('sheet'), pen = document.getElementById('pen');
const strokes = [...document.querySelectorAll('#strokes path')], ways = [...document.querySelectorAll('#ways path')];
const play = document.getElementById('play'), scrub = document.getElementById('scrub');
const speed = document.getElementById('speed'), clock = document.getElementById('clock');
const times = sheet.dataset.times.split(' ').filter(String).map(Number), end = Number(sheet.dataset.end);
const lengths = new Map();
let now = end, shown = strokes.length, part = null, plays = false, before = 0;

function length(path) {
  if (!lengths.has(path)) lengths.set(path, path.getTotalLength());
  return lengths.get(path);
}
function words(seconds) {
  const whole = Math.round(seconds), minutes = Math.floor(whole / 60);
  return minutes ? minutes + ' min ' + String(whole % 60).padStart(2, '0') + ' s' : whole + ' s';
}
function at(t) {
  let low = 0, high = strokes.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[2 * middle + 1] <= t) low = middle + 1; else high = middle;
  }
  return low;
}
function share(t, from, to) { return to > from ? Math.min(1, Math.max(0, (t - from) / (to - from))) : 1; }
function stand(path, done) {
  const place = path.getPointAtLength(done * length(path));
  pen.setAttribute('cx', place.x); pen.setAttribute('cy', place.y);
}
function show(t) {
  now = Math.min(end, Math.max(0, t));
  const next = now >= end ? strokes.length : at(now);
  if (part) { part.removeAttribute('stroke-dasharray'); part.classList.add('off'); part = null; }
  for (let i = Math.min(shown, next); i < Math.max(shown, next); i++) {
    strokes[i].classList.toggle('off', i >= next);
    strokes[i].removeAttribute('stroke-dasharray');
  }
  for (let i = Math.min(shown, next); i <= Math.max(shown, next); i++) ways[i].classList.toggle('off', i > next);
  shown = next;
  const from = next ? times[2 * next - 1] : 0, down = next < strokes.length ? times[2 * next] : end;
  if (next < strokes.length && now >= down) {
    part = strokes[next];
    const done = share(now, down, times[2 * next + 1]);
    part.classList.remove('off');
    part.setAttribute('stroke-dasharray', done * length(part) + ' ' + (length(part) + 1));
    stand(part, done);
  } else if (ways[next]) {
    stand(ways[next], share(now, from, down));
  }
  pen.classList.toggle('lifted', !part);
  scrub.value = end ? 1000 * now / end : 1000;
  const of = strokes[Math.min(next, strokes.length - 1)];
  clock.textContent = words(now) + ' of ' + words(end) + ' · stroke ' + Math.min(next + 1, strokes.length) + ' of '
    + strokes.length + (of && of.dataset.pen ? ' · ' + of.dataset.pen : '');
}
function turn(at_ms) {
  if (!plays) return;
  show(now + (at_ms - before) / 1000 * Number(speed.value));
  before = at_ms;
  if (now >= end) halt(); else requestAnimationFrame(turn);
}
function halt() { plays = false; play.textContent = 'Play'; }
play.addEventListener('click', () => {
  if (plays) { halt(); return; }
  if (now >= end) show(0);
  plays = true; play.textContent = 'Pause'; before = performance.now();
  requestAnimationFrame(turn);
});
scrub.addEventListener('input', () => { halt(); show(end * scrub.value / 1000); });
document.getElementById('travel').addEventListener('change', event => {
  document.getElementById('ways').classList.toggle('off', !event.target.checked);
});
document.getElementById('fade').addEventListener('input', event => {
  document.getElementById('given').setAttribute('opacity', event.target.value / 100);
});
document.getElementById('lines').addEventListener('change', event => {
  document.getElementById('understood').classList.toggle('off', !event.target.checked);
});
show(end);
"""
