#include "cli/demo_report.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "cli/html_page.h"
#include "cli/svg_chart.h"
#include "cli/verdict_files.h"
#include "data/picture.h"
#include "data/task.h"

namespace sandwright {
namespace {

constexpr double kErrorRange_m = 0.012;  // colour scale of differences, as in Deep Sandscapes
constexpr std::array<const char*, 6> kColours = {"#b5651d", "#2f6690", "#8a8a8a",
                                                 "#4b8f5c", "#8e4f9e", "#c23b4b"};

std::string Mm(double metres, int digits = 1) {
  return fmt::format("{:.{}f} mm", 1e3 * metres, digits);
}

// The region's cells, with a rim so that sand pushed out of it shows.
CellRect RegionRect(const HeightMap& map, const Region& region, double rim_m) {
  const auto low = [&](double x) {
    return std::max(0, static_cast<int>(std::floor((x - rim_m) / map.cell_size_m)));
  };
  const auto high = [&](double x, int limit) {
    return std::min(limit, static_cast<int>(std::ceil((x + rim_m) / map.cell_size_m)));
  };
  return {low(region.y_m), low(region.x_m), high(region.y_m + region.depth_m, map.rows),
          high(region.x_m + region.width_m, map.columns)};
}

class Pictures {
 public:
  explicit Pictures(const DemoReport& report) : report_(report) {
    rect_ = RegionRect(report.terrain, report.region, 0.04);
    const HeightMap crop = Crop(report.terrain, rect_);
    const auto [low, high] = std::ranges::minmax_element(crop.height_m);
    low_m_ = *low, high_m_ = *high;
    for (size_t i = 0; i < report.goal.size(); ++i) {
      if (!report.goal.mask[i]) continue;
      low_m_ = std::min<double>(low_m_, report.goal.height_m[i]);
      high_m_ = std::max<double>(high_m_, report.goal.height_m[i]);
    }
    scale_ = std::max(1, 300 / std::max(rect_.rows(), rect_.columns()));
  }

  std::string Heights(const HeightMap& map) const {
    return DataImage(EncodePng(DrawHeights(Crop(map, rect_), low_m_, high_m_, scale_)), Width());
  }
  std::string HeightsWithStroke(const HeightMap& map, const Stroke& stroke) const {
    const HeightMap crop = Crop(map, rect_);
    cv::Mat image = DrawHeights(crop, low_m_, high_m_, scale_);
    ToolPath path = SamplePath(stroke, map.cell_size_m / 2);
    for (BladePose& pose : path)
      pose.x_m -= rect_.column0 * map.cell_size_m, pose.y_m -= rect_.row0 * map.cell_size_m;
    DrawPath(image, crop, path, report_.cell.tool.blade, scale_);
    return DataImage(EncodePng(image), Width());
  }
  std::string Difference(const HeightMap& a, const HeightMap& b) const {
    return DataImage(
        EncodePng(DrawDifference(Crop(a, rect_), Crop(b, rect_), kErrorRange_m, scale_)), Width());
  }

 private:
  static int Width() { return 320; }

  const DemoReport& report_;
  CellRect rect_;
  double low_m_, high_m_;
  int scale_;
};

void AddOutcome(HtmlPage& page, const DemoReport& report) {
  const ShapingRun& run = report.runs.front().run;
  page.Tiles({{Mm(run.start_error_m), "mean goal error at the start"},
              {Mm(run.final_error_m()), fmt::format("after {} strokes", run.strokes.size())},
              {std::to_string(run.rejected()), "strokes that the safety gate rejected"},
              {fmt::format("{:.2f} mm", report.tracking_error_mm),
               "largest distance of blade from plan"}});
}

void AddErrorOverStrokes(HtmlPage& page, const DemoReport& report) {
  Chart chart{.x_label = "strokes", .y_label = "mean |height - goal| [mm]"};
  chart.reference_y = report.success_error_mm;
  chart.reference_name = "goal reached";
  std::vector<std::vector<std::string>> rows;
  for (size_t i = 0; i < report.runs.size(); ++i) {
    const DemoRun& run = report.runs[i];
    ChartSeries series{
        .name = run.agent, .x = {0}, .y = {1e3 * run.run.start_error_m}, .colour = kColours.at(i)};
    double choose_ms = 0;
    for (const ShapingStroke& stroke : run.run.strokes) {
      series.x.push_back(static_cast<double>(series.x.size()));
      series.y.push_back(1e3 * stroke.goal_error_m);
      choose_ms += stroke.choose_ms;
    }
    chart.series.push_back(series);
    const auto count = static_cast<double>(std::max<size_t>(run.run.strokes.size(), 1));
    rows.push_back({run.agent, Mm(run.run.start_error_m, 2), Mm(run.run.final_error_m(), 2),
                    std::to_string(run.run.strokes.size()), std::to_string(run.run.rejected()),
                    fmt::format("{:.1f} ms", choose_ms / count),
                    fmt::format("{:.1f} s", run.seconds)});
  }
  page.Figures({{DrawChart(chart),
                 "Every agent starts from the same scanned bed; errors are measured "
                 "on the rescans."}});
  page.Table({"agent", "start", "end", "strokes", "rejected", "to choose a stroke", "whole run"},
             rows);
}

void AddStrokes(HtmlPage& page, const DemoReport& report, const Pictures& pictures) {
  int number = 0;
  for (const ShapingStroke& stroke : report.runs.front().run.strokes) {
    ++number;
    if (!stroke.verdict.accepted) {
      std::string reasons;
      for (const std::string& reason : stroke.verdict.reasons) reasons += "; " + reason;
      page.Paragraph(fmt::format("Stroke {}: rejected by the gate{}", number, reasons));
      continue;
    }
    page.Figures(
        {{pictures.HeightsWithStroke(stroke.before, stroke.stroke),
          fmt::format("Stroke {}: bed before it, with the blade's path", number)},
         {pictures.Heights(stroke.after),
          fmt::format("after it, rescanned: error {}", Mm(stroke.goal_error_m, 2))},
         {pictures.Difference(stroke.after, stroke.predicted), "rescan less prediction, +-12 mm"}});
  }
}

void AddArm(HtmlPage& page, const DemoReport& report) {
  page.Heading("The arm");
  if (report.arm) {
    page.Figures({{DataImage(EncodePng(*report.arm), report.arm->cols),
                   "The UR10 over the scanned box, half-way through its first stroke, rendered by "
                   "MuJoCo."}});
  } else {
    page.Paragraph(report.arm_note);
  }
  Chart chart{.x_label = "time [s]", .y_label = "joint angle [deg]"};
  chart.from_zero = false;
  chart.width_px = 960;
  const std::array<const char*, 6> names = {"base",    "shoulder", "elbow",
                                            "wrist 1", "wrist 2",  "wrist 3"};
  const size_t step = std::max<size_t>(1, report.time_s.size() / 900);
  for (size_t joint = 0; joint < 6; ++joint) {
    ChartSeries series{.name = names[joint], .colour = kColours[joint], .markers = false};
    for (size_t i = 0; i < report.time_s.size(); ++i) {
      if (i % step != 0 && !std::isnan(report.time_s[i])) continue;
      series.x.push_back(report.time_s[i]);
      series.y.push_back(report.joints_rad[i][joint] * 180 / 3.14159265358979323846);
    }
    chart.series.push_back(std::move(series));
  }
  if (!report.time_s.empty())
    page.Figures(
        {{DrawChart(chart),
          "Joint angles as executed, stroke after stroke (the moves between strokes left out)."}});
}

void AddScan(HtmlPage& page, const DemoReport& report) {
  page.Heading("From frame to terrain");
  page.Paragraph(report.scan_summary);
  std::vector<float> heights = report.terrain.height_m;
  std::ranges::sort(heights);
  const size_t tail = heights.size() / 100;
  const float low = heights[tail], high = heights[heights.size() - 1 - tail];
  const int scale = std::max(1, 480 / report.terrain.columns);
  page.Figures({{DataImage(EncodePng(report.frame), 512),
                 "Depth frame: near is bright, no reading is black."},
                {DataImage(EncodePng(DrawHeights(report.terrain, low, high, scale)), 480),
                 fmt::format("Height map of the sand: {:.0f} x {:.0f} mm, cells of {:.0f} mm; 98 % "
                             "of the heights lie between {} and {}.",
                             1e3 * report.terrain.width_m(), 1e3 * report.terrain.depth_m(),
                             1e3 * report.terrain.cell_size_m, Mm(low), Mm(high))}});
}

void AddGoal(HtmlPage& page, const DemoReport& report, const Pictures& pictures) {
  page.Heading("Goal and result");
  page.Paragraph(fmt::format(
      "The goal covers {:.0f} x {:.0f} mm in the middle of the box and holds as much sand as lies "
      "there. In the pictures of differences red is too high, blue too low, grey does not count; "
      "full colour is 12 mm.",
      1e3 * report.region.width_m, 1e3 * report.region.depth_m));
  const std::vector<ShapingStroke>& strokes = report.runs.front().run.strokes;
  const HeightMap& end = strokes.empty() ? report.terrain : strokes.back().after;
  HeightMap goal_picture = report.terrain;
  for (size_t i = 0; i < report.goal.size(); ++i) {
    if (report.goal.mask[i]) goal_picture.height_m[i] = report.goal.height_m[i];
  }
  page.Figures({{pictures.Heights(report.terrain), "start"},
                {pictures.Heights(goal_picture), "goal"},
                {pictures.Heights(end), "end, rescanned"}});
  page.Figures({{pictures.Difference(report.terrain, report.goal), "start less goal"},
                {pictures.Difference(end, report.goal), "end less goal, rescanned"}});
  AddErrorOverStrokes(page, report);
}

void AddVerdict(HtmlPage& page, const DemoReport& report) {
  if (report.verdict.is_null()) return;
  const auto mm = [&](const char* key) { return fmt::format("{:.1f} mm", report.verdict[key].get<double>()); };
  page.Heading("The verdict before anything moved");
  page.Paragraph(fmt::format(
      "The same agent on this bed in {} sand models, with a rescan after each stroke: {} expected at the end, in nine "
      "of ten cases {} to {}; {} strokes, {:.1f} minutes of the arm.{}",
      report.verdict["worlds"].size(), mm("expected_error_mm"), mm("low90_mm"), mm("high90_mm"),
      report.verdict["strokes"].get<int>(), report.verdict["arm_minutes"].get<double>(),
      report.outcome.is_null() ? "" : " Afterwards: " + OutcomeInWords(report.outcome) + "."));
  page.Figures({{DataImage(EncodePng(report.verdict_picture), report.verdict_picture.cols),
                 "The bed and the expected end against the goal, and where it will be missed by more than 2 mm."}});
}

void AddScript(HtmlPage& page, const DemoReport& report) {
  page.Heading("URScript and files");
  page.Paragraph(report.urscript_note);
  if (!report.urscript.empty()) page.Listing("Show the script", report.urscript);
  page.Paragraph(
      "Beside this page lie the bed and the goal (terrain.h5, goal.h5), the arm's cell "
      "(workcell.yaml), the strokes (plan.yaml) and the figures of this run (demo.json). The "
      "program's other subcommands take them, for example:");
  page.Code(
      "sandwright check --plan plan.yaml --terrain terrain.h5 --workcell workcell.yaml\n"
      "sandwright plan --agent greedy --terrain terrain.h5 --goal goal.h5 "
      "--workcell workcell.yaml --out mine.yaml");
}

}  // namespace

std::string RenderDemoReport(const DemoReport& report) {
  const Pictures pictures(report);
  HtmlPage page("Sandwright: from a depth frame to strokes");
  page.Paragraph(fmt::format(
      "{} was scanned, a goal was set, and the agent \"{}\" chose blade strokes. Those that passed "
      "the safety gate were executed by a simulated UR10 and checked by a rescan.{}",
      report.frame_name, report.runs.front().agent,
      report.stopped ? " The run was stopped before its end; this is what was done." : ""));
  AddOutcome(page, report);
  AddScan(page, report);
  AddVerdict(page, report);
  AddGoal(page, report, pictures);

  page.Heading("Stroke by stroke");
  page.Paragraph(report.model);
  page.Paragraph(report.world);
  AddStrokes(page, report, pictures);
  AddArm(page, report);
  AddScript(page, report);

  page.Heading("Time");
  std::vector<std::vector<std::string>> rows;
  for (const auto& [name, seconds] : report.timings_s)
    rows.push_back({name, fmt::format("{:.2f} s", seconds)});
  page.Table({"part", "wall time"}, rows);
  return page.Finish();
}

}  // namespace sandwright
