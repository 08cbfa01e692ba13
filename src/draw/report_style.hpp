// SPDX-License-Identifier: Apache-2.0
// The style sheet of the report page; figures bring their own (figure_style).
#pragma once

namespace reflectree::draw {

inline constexpr const char* report_style = R"(
:root{color-scheme:light dark;--ink:#1c2333;--soft:#5a6478;--rule:#dde1e9;--page:#eef1f6;--card:#ffffff;
--link:#0b62b0;--good:#0a7a55;--good-back:#dcf3ea;--bad:#b3261e;--bad-back:#fbe4e1}
@media (prefers-color-scheme:dark){:root{--ink:#e9ecf3;--soft:#a0aabd;--rule:#2d3444;--page:#0b0d12;--card:#12151d;
--link:#7cbcf7;--good:#5fd3a5;--good-back:#0f3328;--bad:#ff9b90;--bad-back:#43170f}}
*{box-sizing:border-box}
html{scroll-behavior:smooth}
@media (prefers-reduced-motion:reduce){html{scroll-behavior:auto}}
body{margin:0;background:var(--page);color:var(--ink);
font:16px/1.55 "Inter","Segoe UI","Helvetica Neue",Helvetica,Arial,"Liberation Sans",sans-serif}
main,.top{max-width:1560px;margin:0 auto;padding:0 clamp(16px,3vw,44px)}
.top{padding-top:44px}
h1{font-size:clamp(28px,4vw,42px);line-height:1.1;letter-spacing:-.02em;margin:0 0 10px}
h2{font-size:24px;line-height:1.25;letter-spacing:-.01em;margin:0;overflow-wrap:anywhere}
h3{font-size:15px;font-weight:600;margin:26px 0 10px;color:var(--soft)}
p{max-width:76ch;margin:0 0 12px}
.lead{font-size:18px;color:var(--soft)}
a{color:var(--link)}
:focus-visible{outline:2px solid var(--link);outline-offset:2px}
i,var{font-family:"STIX Two Text","Cambria",Georgia,"Liberation Serif",serif;font-size:1.06em;font-style:italic}
sub{font-size:.72em;line-height:0}
code{font:13px/1.5 ui-monospace,"SF Mono",Menlo,Consolas,"DejaVu Sans Mono",monospace;overflow-wrap:anywhere}
.card{background:var(--card);border:1px solid var(--rule);border-radius:14px;margin:26px 0;padding:clamp(16px,2vw,28px)}
.scroll{overflow-x:auto;padding:6px 0}
table{border-collapse:collapse;width:100%;font-size:14px;font-variant-numeric:tabular-nums}
th,td{padding:8px 12px;text-align:right;white-space:nowrap;border-bottom:1px solid var(--rule)}
thead th{font-weight:600;color:var(--soft);vertical-align:bottom;line-height:1.3}
thead th small,td small{display:block;font-weight:400;color:var(--soft);font-size:12px}
tbody tr:last-child>*{border-bottom:0}
th:first-child,td.word,th.word{text-align:left}
tbody th{font-weight:600;white-space:normal;min-width:190px}
tbody tr:hover{background:color-mix(in srgb,var(--link) 6%,transparent)}
.name{display:flex;gap:12px;align-items:center}
.name svg{width:44px;height:44px;flex:none}
.name a{text-decoration:none;overflow-wrap:anywhere}.name a:hover{text-decoration:underline}
.verdict{display:inline-block;border-radius:99px;padding:1px 10px;font-weight:600;font-size:13px}
.pass{color:var(--good);background:var(--good-back)}
.fail{color:var(--bad);background:var(--bad-back)}
.head{display:flex;flex-wrap:wrap;gap:4px 16px;align-items:baseline;justify-content:space-between}
.origin{color:var(--soft);margin:2px 0 0}
dl{display:grid;grid-template-columns:repeat(auto-fit,minmax(118px,1fr));gap:1px;background:var(--rule);
border:1px solid var(--rule);border-radius:10px;overflow:hidden;margin:18px 0 0}
dl div{background:var(--card);padding:10px 14px;display:flex;flex-direction:column-reverse;justify-content:flex-end}
dt{font-size:12px;color:var(--soft);line-height:1.3}
dd{margin:0;font-size:17px;font-weight:600;font-variant-numeric:tabular-nums;overflow-wrap:anywhere}
.pictures{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(310px,100%),1fr));gap:8px}
figure{margin:0}
figure svg{display:block;width:100%;height:auto}
.pictures figure{max-width:440px}
.pictures.wide{grid-template-columns:repeat(auto-fit,minmax(min(420px,100%),1fr))}
.pictures.wide figure{max-width:620px}
.pictures.two{grid-template-columns:repeat(auto-fit,minmax(min(500px,100%),1fr));gap:16px}
.pictures.two figure{max-width:720px}
figure.whole{overflow-x:auto}
summary{cursor:pointer;color:var(--link);margin-top:18px}
.one-of-many{display:none}.one-of-many:target{display:block}
main:not(:has(.one-of-many:target)) .one-of-many.first{display:block}
.how{margin-top:12px;columns:2 340px;column-gap:44px;font-size:15px}
.how p{break-inside:avoid}
footer{color:var(--soft);font-size:14px;padding:10px 0 60px}
@media print{body{background:#fff}.one-of-many{display:block}.card{break-inside:avoid-page;border:0;padding:0}}
)";

}  // namespace reflectree::draw
