//! The page's style sheet: light, plain, printable.

pub(super) const CSS: &str = "
:root { color-scheme: light; --ink: #212529; --soft: #5a6066; --line: #d9dde1; --accent: #005cb8; }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 2.5rem 2rem 4rem; max-width: 62rem; background: #fff; color: var(--ink);
  font: 15px/1.5 system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', sans-serif; }
header { border-bottom: 2px solid var(--ink); margin-bottom: 1.5rem; }
header p { margin: 0 0 .75rem; color: var(--soft); }
h1 { font-size: 1.7rem; line-height: 1.2; margin: 0 0 .25rem; overflow-wrap: anywhere; }
h2 { font-size: 1.2rem; margin: 2.2rem 0 .6rem; padding-bottom: .25rem; border-bottom: 1px solid var(--line); }
h3 { font-size: 1rem; margin: 1.2rem 0 .4rem; }
p { margin: .4rem 0 .8rem; max-width: 46rem; }
table { border-collapse: collapse; margin: .4rem 0 1rem; font-variant-numeric: tabular-nums; }
th, td { padding: .22rem .9rem .22rem 0; text-align: left; vertical-align: top; border-bottom: 1px solid var(--line); }
thead th { color: var(--soft); font-weight: 600; border-bottom: 1px solid var(--soft); }
tbody th { font-weight: 400; color: var(--soft); }
td.number { text-align: right; }
.columns { display: flex; flex-wrap: wrap; gap: 0 3rem; }
.key { display: flex; flex-wrap: wrap; gap: .75rem; margin: 1rem 0 1.5rem; padding: 0; list-style: none; }
.key li { border: 1px solid var(--line); border-radius: 6px; padding: .5rem .9rem; min-width: 9.5rem; }
.key b { display: block; font-size: 1.25rem; font-weight: 600; font-variant-numeric: tabular-nums; }
.key span { color: var(--soft); font-size: .85rem; }
.badge { display: inline-block; margin-left: .6rem; padding: 0 .55rem; border-radius: 1rem; font-size: .75rem;
  font-weight: 600; line-height: 1.6; vertical-align: middle; }
.current { background: #dff3e6; color: #0e6a33; }
.stale { background: #fdeecd; color: #7a4a00; }
.missing { background: #e9ecef; color: #495057; }
figure { margin: 1rem 0 1.5rem; }
figure svg, figure img { display: block; max-width: 100%; height: auto; }
figcaption { color: var(--soft); font-size: .9rem; margin-top: .3rem; }
footer { margin-top: 3rem; padding-top: .6rem; border-top: 1px solid var(--line); color: var(--soft); font-size: .85rem; }
@page { margin: 16mm; }
@media print {
  body { padding: 0; max-width: none; font-size: 10.5pt; }
  h2, h3 { break-after: avoid; }
  figure, table, .key { break-inside: avoid; }
}
";
