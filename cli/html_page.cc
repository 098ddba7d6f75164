#include "cli/html_page.h"

#include <spdlog/fmt/fmt.h>

#include <cstdint>

namespace sandwright {
namespace {

constexpr std::string_view kStyle = R"(
:root { --ink: #2d2620; --soft: #7b6f63; --line: #e4d9c8; --sand: #b78f5f; --paper: #fdfbf7; }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink);
       font: 16px/1.55 system-ui, sans-serif; }
main { max-width: 1080px; margin: 0 auto; padding: 40px 24px 80px; }
h1 { font-size: 32px; line-height: 1.2; margin: 0 0 8px; }
h2 { font-size: 21px; margin: 44px 0 8px; padding-top: 20px; border-top: 1px solid var(--line); }
p { max-width: 72ch; margin: 8px 0; }
.figures { display: flex; flex-wrap: wrap; gap: 20px; margin: 16px 0; align-items: flex-start; }
figure { margin: 0; max-width: 100%; display: table; }
figure img { display: block; max-width: 100%; height: auto; border-radius: 4px; }
figcaption { color: var(--soft); font-size: 13.5px; padding-top: 6px;
             display: table-caption; caption-side: bottom; }
.tiles { display: flex; flex-wrap: wrap; gap: 14px; margin: 20px 0; }
.tile { background: #fff; border: 1px solid var(--line); border-radius: 8px; padding: 12px 18px; }
.tile b { display: block; font-size: 24px; } .tile span { color: var(--soft); font-size: 13.5px; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; margin: 14px 0; font-size: 14.5px;
        font-variant-numeric: tabular-nums; }
th, td { text-align: right; padding: 5px 14px 5px 0; border-bottom: 1px solid var(--line);
         white-space: nowrap; }
th:first-child, td:first-child { text-align: left; }
th { color: var(--soft); font-weight: 600; }
pre { background: #fff; border: 1px solid var(--line); border-radius: 6px; padding: 14px;
      overflow: auto; max-height: 480px; font-size: 13px; line-height: 1.4; }
summary { cursor: pointer; color: var(--sand); font-weight: 600; margin: 14px 0; }
svg.chart { background: #fff; border: 1px solid var(--line); border-radius: 6px;
            max-width: 100%; height: auto; }
svg .grid { stroke: var(--line); } svg .reference { stroke: var(--soft); stroke-dasharray: 5 4; }
svg .tick { font: 12px system-ui, sans-serif; fill: var(--soft); }
svg .label { font: 13px system-ui, sans-serif; fill: var(--ink); }
)";

std::string Base64(std::string_view bytes) {
  static constexpr char kAlphabet[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t group = 0;
    for (size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : kAlphabet[group >> (18 - 6 * k) & 63];
  }
  return text;
}

}  // namespace

std::string EscapeHtml(std::string_view text) {
  std::string out;
  for (char c : text) {
    switch (c) {
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '&': out += "&amp;"; break;
      case '"': out += "&quot;"; break;
      default: out += c;
    }
  }
  return out;
}

std::string DataImage(std::string_view png, int width_px) {
  return fmt::format("<img width=\"{}\" alt=\"\" src=\"data:image/png;base64,{}\">", width_px,
                     Base64(png));
}

void HtmlPage::Heading(const std::string& text) { body_ += "<h2>" + EscapeHtml(text) + "</h2>\n"; }

void HtmlPage::Paragraph(const std::string& text) { body_ += "<p>" + EscapeHtml(text) + "</p>\n"; }

void HtmlPage::Figures(const std::vector<PageFigure>& figures) {
  body_ += "<div class=\"figures\">\n";
  for (const PageFigure& figure : figures)
    body_ += "<figure>" + figure.content + "<figcaption>" + EscapeHtml(figure.caption) +
             "</figcaption></figure>\n";
  body_ += "</div>\n";
}

void HtmlPage::Tiles(const std::vector<std::pair<std::string, std::string>>& tiles) {
  body_ += "<div class=\"tiles\">\n";
  for (const auto& [value, name] : tiles)
    body_ += "<div class=\"tile\"><b>" + EscapeHtml(value) + "</b><span>" + EscapeHtml(name) +
             "</span></div>\n";
  body_ += "</div>\n";
}

void HtmlPage::Table(const std::vector<std::string>& header,
                     const std::vector<std::vector<std::string>>& rows) {
  const auto row = [&](const std::vector<std::string>& cells, const char* tag) {
    body_ += "<tr>";
    for (const std::string& cell : cells)
      body_ += fmt::format("<{0}>{1}</{0}>", tag, EscapeHtml(cell));
    body_ += "</tr>\n";
  };
  body_ += "<div class=\"scroll\"><table>\n";
  row(header, "th");
  for (const auto& cells : rows) row(cells, "td");
  body_ += "</table></div>\n";
}

void HtmlPage::Code(const std::string& text) { body_ += "<pre>" + EscapeHtml(text) + "</pre>\n"; }

void HtmlPage::Listing(const std::string& summary, const std::string& text) {
  body_ += "<details><summary>" + EscapeHtml(summary) + "</summary><pre>" + EscapeHtml(text) +
           "</pre></details>\n";
}

std::string HtmlPage::Finish() const {
  const std::string title = EscapeHtml(title_);
  const std::string refresh =
      refresh_s_ > 0 ? fmt::format("<meta http-equiv=\"refresh\" content=\"{}\">", refresh_s_) : "";
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
      "{}<title>{}</title><style>{}</style></head>\n<body><main>\n<h1>{}</h1>\n{}</main></body></"
      "html>\n",
      refresh, title, kStyle, title, body_);
}

}  // namespace sandwright
