// The page's style sheet: one column, rules as in a printed table, colours for light and dark that the figures follow.
#pragma once
#include <string_view>

namespace sysid {

inline constexpr std::string_view page_style = R"css(:root {
  color-scheme: light dark;
  --paper: #ffffff; --ink: #1f2933; --muted: #66717d; --rule: #d5dbe1; --faint: #f4f6f8; --accent: #1b5e9b;
  --good: #2d7d5a; --doubtful: #b07a12; --bad: #b3372f;
  --fig-ink: #1f2933; --fig-muted: #66717d; --fig-rule: #e3e7ec; --fig-paper: none; --fig-model: #1b5e9b; --fig-band: #a9c8e4;
  --fig-noise-band: #dce8f3; --fig-data: #3d4852; --fig-contrast: #b4541a;
  --fig-chain-1: #1b5f9c; --fig-chain-2: #c8741f; --fig-chain-3: #2d8a6b; --fig-chain-4: #7a5195;
  --fig-chain-5: #8c6d31; --fig-chain-6: #4a90a4; --fig-chain-7: #a63d57; --fig-chain-8: #5c7a29;
}
@media screen and (prefers-color-scheme: dark) {
  :root {
    --paper: #14181d; --ink: #dfe4ea; --muted: #95a1ad; --rule: #343d47; --faint: #1c2229; --accent: #7db8e8;
    --good: #5cbf92; --doubtful: #dcab4f; --bad: #e8857c;
    --fig-ink: #dfe4ea; --fig-muted: #95a1ad; --fig-rule: #2a323b; --fig-model: #7db8e8; --fig-band: #33597c;
    --fig-noise-band: #20354a; --fig-data: #c3cbd3; --fig-contrast: #ee9a63;
    --fig-chain-1: #7db8e8; --fig-chain-2: #eaa35c; --fig-chain-3: #67c2a2; --fig-chain-4: #b793d1;
    --fig-chain-5: #c9ab6b; --fig-chain-6: #86c5d6; --fig-chain-7: #e08aa0; --fig-chain-8: #a3c26a;
  }
}
* { box-sizing: border-box; }
html { font: 16px/1.55 system-ui, -apple-system, "Segoe UI", "Helvetica Neue", Arial, "Liberation Sans", sans-serif; }
body { margin: 0; background: var(--paper); color: var(--ink); }
main { max-width: 54rem; margin: 0 auto; padding: 2.5rem 1.5rem 4rem; }
header { border-bottom: 2px solid var(--ink); padding-bottom: 1rem; margin-bottom: 1.5rem; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0; font-weight: 650; letter-spacing: -0.01em; }
h2 { font-size: 1.15rem; margin: 2.4rem 0 0.7rem; font-weight: 650; }
h3 { font-size: 1rem; margin: 1.4rem 0 0.4rem; font-weight: 600; }
p { margin: 0.5rem 0; }
.task { margin: 0 0 0.2rem; color: var(--accent); font-weight: 600; }
.what { margin: 0.4rem 0 0; color: var(--muted); }
.verdict { border-left: 5px solid var(--good); background: var(--faint); padding: 0.7rem 1.1rem; margin: 1.5rem 0; }
.verdict strong { color: var(--good); }
.verdict > p::first-letter { text-transform: uppercase; }
.verdict.doubtful { border-color: var(--doubtful); } .verdict.doubtful strong { color: var(--doubtful); }
.verdict.bad { border-color: var(--bad); } .verdict.bad strong { color: var(--bad); }
.verdict ul { margin: 0.4rem 0 0.2rem; padding-left: 1.2rem; }
.verdict li { margin: 0.25rem 0; }
.verdict li.error::marker { color: var(--bad); } .verdict li.warning::marker { color: var(--doubtful); }
.verdict em { font-style: normal; color: var(--muted); }
.equations { font: 1.25rem/1.7 "STIX Two Text", Cambria, Georgia, "Liberation Serif", serif; margin: 0.6rem 0 1.2rem; padding-left: 1.5rem; }
.equations p { margin: 0.1rem 0; }
sup { line-height: 0; font-size: 0.7em; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; border-top: 1.5px solid var(--ink); border-bottom: 1.5px solid var(--ink); margin: 0.6rem 0; font-size: 0.92rem; }
th, td { padding: 0.28rem 1.1rem 0.28rem 0; text-align: left; vertical-align: baseline; }
th:last-child, td:last-child { padding-right: 0.2rem; }
th { font-weight: 600; color: var(--muted); border-bottom: 1px solid var(--rule); white-space: nowrap; }
.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
td b { font-weight: 600; }
td:first-child { white-space: nowrap; }
td code { font-size: 0.92em; }
code, pre, .digest { font-family: ui-monospace, "SF Mono", Menlo, Consolas, "Liberation Mono", monospace; font-size: 0.85em; }
.digest { color: var(--muted); overflow-wrap: anywhere; }
pre { background: var(--faint); padding: 0.9rem 1.1rem; overflow-x: auto; line-height: 1.45; }
details { margin: 0.8rem 0; }
summary { cursor: pointer; color: var(--accent); }
figure { margin: 1.2rem 0 2.2rem; }
figure svg { width: 100%; height: auto; display: block; }
figcaption, .caption { color: var(--muted); font-size: 0.88rem; max-width: 46rem; }
figcaption b { color: var(--ink); }
figcaption { margin-top: 0.4rem; }
footer { margin-top: 3rem; padding-top: 0.7rem; border-top: 1px solid var(--rule); color: var(--muted); font-size: 0.85rem; }
@media print {
  html { font-size: 10.5pt; }
  main { max-width: none; padding: 0; }
  figure, table, .verdict { break-inside: avoid; }
  h2 { break-after: avoid; }
}
)css";

}  // namespace sysid
