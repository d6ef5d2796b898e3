#include "io/report.hpp"

#include "io/plot.hpp"

namespace bramah {
namespace {

using plot::escaped;

constexpr const char* kStyle = R"(
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--ink); font: 15px/1.55 system-ui, -apple-system, "Segoe UI", Roboto,
  "Helvetica Neue", Arial, sans-serif; }
main { max-width: 1080px; margin: 0 auto; padding: 40px 28px 56px; }
h1 { font-size: 27px; line-height: 1.25; margin: 0 0 6px; letter-spacing: -0.01em; }
h2 { font-size: 18px; margin: 44px 0 10px; padding-bottom: 6px; border-bottom: 1px solid var(--rule); }
p { margin: 8px 0 14px; max-width: 78ch; } .lead { color: var(--soft); } footer { color: var(--soft); font-size: 13px; margin-top: 48px; }
.facts { display: flex; flex-wrap: wrap; gap: 12px; margin: 24px 0 8px; }
.facts div { flex: 1 1 150px; border: 1px solid var(--rule); border-radius: 8px; padding: 10px 14px; }
.facts dt { color: var(--soft); font-size: 12.5px; } .facts dd { margin: 0; font-size: 20px; font-weight: 600; }
figure { margin: 14px 0; } figcaption, caption { color: var(--soft); font-size: 13px; text-align: left; }
caption { padding-bottom: 6px; } figure svg { width: 100%; height: auto; display: block; }
.pair { display: grid; grid-template-columns: repeat(auto-fit, minmax(440px, 1fr)); gap: 10px 20px; }
.wide { overflow-x: auto; margin: 14px 0 20px; }
table { border-collapse: collapse; font-size: 13.5px; font-variant-numeric: tabular-nums; }
th { text-align: left; color: var(--soft); font-weight: 600; } th, td { padding: 4px 20px 4px 0; border-bottom: 1px solid var(--rule); white-space: nowrap; }
td:last-child:not(.r) { white-space: normal; min-width: 7em; }
th.r, td.r { text-align: right; } @media print { main { padding: 0; max-width: none; } }
)";

void append_row(std::string& out, const Table& table, const std::vector<std::string>& row, const char* cell) {
  out += "<tr>";
  for (std::size_t k = 0; k < row.size(); ++k) {
    const bool right = k < table.right.size() && table.right[k] == 'r';
    out += std::string("<") + cell + (right ? " class=\"r\">" : ">") + escaped(row[k]) + "</" + cell + ">";
  }
  out += "</tr>\n";
}

}  // namespace

void Report::facts(const std::vector<std::pair<std::string, std::string>>& list) {
  body_ += "<dl class=\"facts\">\n";
  for (const auto& [label, value] : list) {
    body_ += "<div><dt>" + escaped(label) + "</dt><dd>" + escaped(value) + "</dd></div>\n";
  }
  body_ += "</dl>\n";
}

void Report::heading(const std::string& text) { body_ += "<h2>" + escaped(text) + "</h2>\n"; }

void Report::paragraph(const std::string& text) { body_ += "<p>" + escaped(text) + "</p>\n"; }

void Report::table(const Table& table, const std::string& caption) {
  body_ += "<div class=\"wide\"><table>\n";
  if (!caption.empty()) body_ += "<caption>" + escaped(caption) + "</caption>\n";
  if (!table.header.empty()) append_row(body_, table, table.header, "th");
  for (const auto& row : table.rows) append_row(body_, table, row, "td");
  body_ += "</table></div>\n";
}

void Report::figure(const std::string& svg, const std::string& caption) {
  body_ += "<figure>\n" + svg;
  if (!caption.empty()) body_ += "<figcaption>" + escaped(caption) + "</figcaption>\n";
  body_ += "</figure>\n";
}

void Report::figures(const std::vector<std::string>& svgs) {
  body_ += "<div class=\"pair\">\n";
  for (const std::string& svg : svgs) figure(svg);
  body_ += "</div>\n";
}

std::string Report::html(const std::string& footer) const {
  std::string page = "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  page += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" + escaped(title_) +
          "</title>\n";
  page += "<style>\n" + plot::style_sheet() + kStyle + "</style>\n</head>\n<body>\n<main>\n<h1>" + escaped(title_) +
          "</h1>\n";
  if (!description_.empty()) page += "<p class=\"lead\">" + escaped(description_) + "</p>\n";
  page += body_ + "<footer>" + escaped(footer) + "</footer>\n</main>\n</body>\n</html>\n";
  return page;
}

}  // namespace bramah
