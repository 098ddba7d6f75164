// A self-contained HTML page: style, pictures and charts inside one file.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sandwright {

struct PageFigure {
  std::string content;  // an element: DataImage(...) or an <svg>
  std::string caption;  // plain text
};

// Texts are escaped; elements (figures) go in as they are.
class HtmlPage {
 public:
  // `refresh_s`: a browser loads the page anew so often; 0: never.
  explicit HtmlPage(std::string title, int refresh_s = 0)
      : title_(std::move(title)), refresh_s_(refresh_s) {}

  void Heading(const std::string& text);
  void Paragraph(const std::string& text);
  // Figures side by side, wrapping where the page is narrow.
  void Figures(const std::vector<PageFigure>& figures);
  // The big figures of a run: value over name.
  void Tiles(const std::vector<std::pair<std::string, std::string>>& value_and_name);
  void Table(const std::vector<std::string>& header,
             const std::vector<std::vector<std::string>>& rows);
  // An element of its own, as it is.
  void Element(const std::string& html) { body_ += html + "\n"; }
  // Lines to copy into a shell.
  void Code(const std::string& text);
  // Behind a disclosure triangle: for long listings.
  void Listing(const std::string& summary, const std::string& text);

  std::string Finish() const;

 private:
  std::string title_, body_;
  int refresh_s_;
};

// <img> with the PNG inside, for a shown width in pixels.
std::string DataImage(std::string_view png, int width_px);

std::string EscapeHtml(std::string_view text);

}  // namespace sandwright
