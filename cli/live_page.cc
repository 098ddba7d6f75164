#include "cli/live_page.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "cli/html_page.h"

namespace sandwright {
namespace {

constexpr int kRefresh_s = 5, kRefreshEnded_s = 60;  // a run that ended may be gone on with
constexpr int kPicture_px = 480;
constexpr double kShortestAlarm_s = 60;  // of silence; and three times the longest so far

// Only the reader's clock knows how old the page is.
constexpr const char* kAgeScript = R"(<p id="age"></p><script>
const line = document.getElementById("age"), written = Date.parse("{0}"), running = {1}, alarm_s = {2:.0f};
function spoken(s) {{
  return s < 120 ? Math.round(s) + " s" : s < 7200 ? Math.round(s / 60) + " min" : Math.round(s / 3600) + " h";
}}
function tell() {{
  const age_s = Math.max(0, (Date.now() - written) / 1000);
  line.textContent = "Written " + spoken(age_s) + " ago.";
  if (running && age_s > alarm_s) {{
    line.textContent += " No sign of life since: the run was killed, or hangs. Its state is still \"running\".";
    line.style.color = "#b3261e";
  }}
}}
tell(); setInterval(tell, 1000);
</script>)";

std::string Duration(double seconds) {
  if (seconds < 120) return fmt::format("{:.0f} s", seconds);
  if (seconds < 7200) return fmt::format("{:.0f} min", seconds / 60);
  return fmt::format("{:.1f} h", seconds / 3600);
}

std::string Value(const nlohmann::json& value) {
  return value.is_number_float() ? fmt::format("{:.4g}", value.get<double>())
         : value.is_string()     ? value.get<std::string>()
                                 : value.dump();
}

void AddProgress(HtmlPage& page, const RunReport& report) {
  std::vector<std::pair<std::string, std::string>> tiles = {{NameOf(report.state), "state"}};
  tiles.emplace_back(report.total > 0 ? fmt::format("{} of {}", report.done, report.total)
                                      : fmt::format("{}", report.done),
                     report.unit);
  if (report.rate_per_s > 0)
    tiles.emplace_back(report.rate_per_s < 0.1 ? fmt::format("{:.3g} / min", 60 * report.rate_per_s)
                                               : fmt::format("{:.3g} / s", report.rate_per_s),
                       "rate");
  if (report.left_s) tiles.emplace_back(Duration(*report.left_s), "left");
  page.Tiles(tiles);
}

}  // namespace

std::string RenderLivePage(const RunReport& report) {
  const bool running = report.state == RunState::kRunning;
  HtmlPage page(fmt::format("sandwright {}: {}", report.command, NameOf(report.state)),
                running ? kRefresh_s : kRefreshEnded_s);
  page.Paragraph(fmt::format("Began {}, last news {}.", report.began, report.updated));
  page.Element(fmt::format(fmt::runtime(kAgeScript), report.updated, running,
                           std::max(kShortestAlarm_s, 3 * report.longest_silence_s)));
  AddProgress(page, report);
  if (!report.text.empty()) page.Code(report.text);
  if (!report.note.empty()) page.Paragraph(report.note);
  if (!report.last_warning.empty())
    page.Paragraph(
        fmt::format("Last warning, {}: {}", report.last_warning_time, report.last_warning));
  std::vector<PageFigure> pictures;
  for (const RunPicture& picture : report.pictures)
    pictures.push_back({DataImage(picture.png(), kPicture_px), picture.caption});
  if (!pictures.empty()) page.Figures(pictures);
  std::vector<std::vector<std::string>> rows;
  for (const auto& [name, value] : report.figures.items()) rows.push_back({name, Value(value)});
  if (!rows.empty()) page.Table({"last figures", ""}, rows);
  return page.Finish();
}

}  // namespace sandwright
