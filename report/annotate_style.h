#pragma once

namespace mocurate {

/// Timelines, cards and the bar of labels, after the styles of all pages and of the review.
inline constexpr const char* kAnnotateStyle = R"css(
[hidden] { display: none !important; }
.track { position: relative; overflow: hidden; border-radius: 8px; background: var(--page); cursor: crosshair;
  user-select: none; touch-action: none; }
.track canvas { display: block; width: 100%; height: 92px; } .lanes { position: relative; min-height: 28px; }
.span { position: absolute; height: 24px; min-width: 4px; padding: 0 5px; overflow: hidden; white-space: nowrap;
  text-align: left; font-size: 13px; line-height: 20px; color: var(--ink); border: 2px solid hsl(var(--hue) 60% 45%);
  background: hsl(var(--hue) 60% 50% / .25); border-radius: 5px; }
.span[aria-pressed=true] { box-shadow: 0 0 0 2px var(--ink) inset; font-weight: 600; }
.span.proposed { border-style: dashed; background: none; }
.span.unnamed { border-color: var(--bad); font-style: italic; }
.playhead, .mark, .drawn { position: absolute; top: 0; bottom: 0; pointer-events: none; }
.playhead { width: 2px; margin-left: -1px; background: var(--ink); } .mark { width: 2px; background: var(--bad); }
.drawn { background: hsl(210 60% 50% / .3); }
.bar { position: sticky; top: 0; z-index: 2; background: var(--card); border-bottom: 1px solid var(--rule);
  padding: 8px 0; }
.bar > div { max-width: 1080px; margin: 0 auto; padding: 0 24px; display: flex; flex-wrap: wrap; gap: 6px 10px;
  align-items: center; font-size: 14px; }
.bar progress { width: 120px; } #message { font-weight: 600; }
#labels { max-height: 92px; overflow-y: auto; padding-top: 6px; }
#labels button { border-left: 8px solid hsl(var(--hue) 60% 45%); }
.annotated:focus { outline: none; } .annotated { content-visibility: auto; contain-intrinsic-size: auto 420px; }
.annotated.done h2::after { content: " done"; color: var(--good); }
.only-undone .annotated.done:not(.here) { display: none; }
.annotated .clip { align-items: start; } .verdicts input.label { width: 136px; }
.annotated .verdicts input[type=number] { width: 80px; } .done-button[aria-pressed=true] { border-color: var(--good); }
)css";

}  // namespace mocurate
