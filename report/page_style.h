#pragma once

namespace mocurate {

/// Light and dark by the reader's preference; system fonts; no external resources.
inline constexpr const char* kPageStyle = R"css(
:root { color-scheme: light dark;
  --page: #f6f7f9; --card: #ffffff; --ink: #1c2127; --soft: #5a6470; --rule: #d9dee5; --grid: #e3e7ec;
  --before: #8b95a1; --after: #2563c9; --left: #2563c9; --right: #c2571a; --good: #2c7d4f; --suspect: #b07d00; --bad: #b3392f;
  --heat: 37, 99, 201; }
@media (prefers-color-scheme: dark) { :root {
  --page: #14171b; --card: #1c2127; --ink: #e6e9ed; --soft: #a0a9b4; --rule: #343b44; --grid: #2b323a;
  --before: #8b95a1; --after: #6ba0f5; --left: #6ba0f5; --right: #f0965a; --good: #5fbf8a; --suspect: #e0b040; --bad: #ee7d72;
  --heat: 70, 130, 235; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--ink); font: 16px/1.5 system-ui, -apple-system, "Segoe UI", Roboto,
  "Helvetica Neue", Arial, sans-serif; font-variant-numeric: tabular-nums; }
.skip { position: absolute; left: -999px; } .skip:focus { left: 8px; top: 8px; }
header, main, footer { max-width: 1080px; margin: 0 auto; padding: 0 24px; }
header { padding-top: 36px; } footer { padding-bottom: 48px; color: var(--soft); font-size: 14px; }
h1 { font-size: 30px; line-height: 1.2; margin: 0 0 4px; } h2 { font-size: 20px; margin: 0 0 10px; line-height: 1.3; }
h3 { font-size: 16px; margin: 24px 0 6px; overflow-wrap: anywhere; }
p { margin: 0 0 10px; max-width: 78ch; } a { color: var(--after); }
.lead { font-size: 17px; color: var(--soft); } .verdict { font-size: 18px; margin-top: 16px; font-weight: 600; }
.soft { color: var(--soft); font-size: 14px; }
section { background: var(--card); border: 1px solid var(--rule); border-radius: 10px; padding: 20px 24px; margin: 20px 0; }
nav ol { list-style: none; display: flex; flex-wrap: wrap; gap: 4px 18px; padding: 0; margin: 16px 0 0; font-size: 14px; }
dt { font-weight: 600; } dd { margin: 0 0 8px; max-width: 78ch; } #reading dl { margin: 0; }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(150px, 1fr)); gap: 12px; margin: 20px 0 4px; padding: 0; }
.tiles div { background: var(--card); border: 1px solid var(--rule); border-radius: 10px; padding: 12px 16px; }
.tiles dt { color: var(--soft); font-size: 13px; font-weight: 400; } .tiles dd { margin: 0; font-size: 24px; font-weight: 600; }
.tiles small { display: block; font-size: 13px; font-weight: 400; color: var(--soft); }
.scroll { overflow-x: auto; margin: 8px 0 14px; }
table { border-collapse: collapse; font-size: 14px; min-width: min(420px, 100%); } caption { text-align: left; color: var(--soft); padding-bottom: 6px; }
th, td { padding: 5px 14px 5px 0; border-bottom: 1px solid var(--rule); text-align: left; vertical-align: top; }
thead th { color: var(--soft); font-weight: 600; white-space: nowrap; } tbody th { font-weight: 500; overflow-wrap: anywhere; }
.numeric td, .numeric thead th:not(:first-child) { text-align: right; white-space: nowrap; }
svg { display: block; width: 100%; height: auto; } svg.strip { background: var(--page); border-radius: 8px; max-height: 240px; }
.label { font-size: 12px; fill: var(--soft); } .value { font-size: 12px; fill: var(--ink); }
.before { fill: var(--before); } .after { fill: var(--after); } .good { fill: var(--good); } .suspect { fill: var(--suspect); }
.bad { fill: var(--bad); } .axis { stroke: var(--soft); } .grid { stroke: var(--grid); }
.median { stroke: var(--ink); stroke-width: 1.5; stroke-dasharray: 3 2; }
.curve { fill: none; stroke-width: 2; stroke-linejoin: round; } .c0 { stroke: #2563c9; } .c1 { stroke: #c2571a; }
.c2 { stroke: #2c8a57; } .c3 { stroke: #8a4fbf; } .c4 { stroke: #b08900; } .c5 { stroke: #7b8794; }
.seen { stroke: var(--before); stroke-width: 1.2; } .point { fill: var(--page); stroke: var(--ink); stroke-width: 1; }
svg.strip .label { font-size: 13px; }
.bone { stroke: var(--after); stroke-width: 3; stroke-linecap: round; } .bone.left { stroke: var(--left); }
.bone.right { stroke: var(--right); }
.charts { display: grid; grid-template-columns: repeat(auto-fit, minmax(300px, 1fr)); gap: 14px 28px; margin: 12px 0; }
.charts.wide { grid-template-columns: repeat(auto-fit, minmax(440px, 1fr)); }
figure { margin: 0; } figcaption { font-size: 14px; color: var(--soft); margin-bottom: 4px; }
.clip { display: grid; grid-template-columns: minmax(0, 1fr) 300px; gap: 18px; align-items: center; }
code { white-space: nowrap; }
video { display: block; max-width: 100%; max-height: 560px; border-radius: 8px; margin: 0 0 14px; background: #181c22; }
.player.alone { max-width: 560px; margin-top: 14px; } .player.alone canvas { height: 340px; }
.s-observed { fill: var(--grid); background: var(--grid); } .s-repaired { fill: var(--bad); background: var(--bad); }
.s-interpolated { fill: var(--suspect); background: var(--suspect); } .s-inferred { fill: var(--soft); background: var(--soft); }
.states .label { font-size: 10px; }
.player canvas { width: 100%; height: 230px; display: block; background: var(--page); border-radius: 8px; cursor: grab;
  touch-action: none; }
.player canvas:focus-visible, button:focus-visible, input:focus-visible, a:focus-visible { outline: 2px solid var(--after);
  outline-offset: 2px; }
.controls { display: flex; align-items: center; gap: 8px; margin-top: 6px; font-size: 13px; flex-wrap: wrap; }
.controls input[type=range] { flex: 1; min-width: 70px; } .controls output { min-width: 52px; text-align: right; }
button { font: inherit; padding: 2px 10px; min-width: 64px; border: 1px solid var(--rule); border-radius: 6px; background: var(--card);
  color: inherit; cursor: pointer; }
.overlays { display: flex; flex-wrap: wrap; gap: 14px; margin-top: 14px; }
.overlays img { max-width: 100%; height: 400px; object-fit: contain; display: block; border-radius: 8px; }
.overlays figcaption { margin: 4px 0 0; }
.heat td { text-align: center; padding: 3px 0; min-width: 30px; border: 1px solid var(--card); } .heat td:empty { background: var(--page); }
.heat th { padding: 3px 10px 3px 0; border: 0; } .heat thead th { text-align: center; padding: 3px 0; } .heat .hot { color: #fff; }
.key span { display: inline-block; width: 12px; height: 12px; border-radius: 3px; margin: 0 5px 0 12px; vertical-align: -1px; }
.key .k-before { background: var(--before); margin-left: 0; } .key .k-left { background: var(--left); } .key .k-right { background: var(--right); }
.key .k-good { background: var(--good); margin-left: 0; } .key .k-suspect { background: var(--suspect); } .key .k-bad { background: var(--bad); }
.key .k-after { background: var(--after); }
summary { cursor: pointer; font-size: 14px; color: var(--soft); }
@media (max-width: 760px) { .charts.wide { grid-template-columns: 1fr; } .clip { grid-template-columns: 1fr; } header, main, footer { padding-left: 14px; padding-right: 14px; } }
@media print { section { break-inside: avoid; } .player { display: none; } .clip { grid-template-columns: 1fr; } }
)css";

}  // namespace mocurate
