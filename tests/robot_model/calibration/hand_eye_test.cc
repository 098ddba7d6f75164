// The camera on the flange: it comes back from noisy frames, wrong frames are named, poor sets refused.
#include "robot_model/calibration/hand_eye.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/support/refusal.h"
#include "tests/support/simulated_calibration.h"

namespace sandwright {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const CharucoBoard kBoard;

class HandEyeCalibrated : public ::testing::Test {
 protected:
  RandomStream stream{7, StreamId("hand-eye test")};
  Workcell truth = TrueCell(stream);
  Workcell nominal = NominalCell(truth);

  HandEyeCalibration Calibrate(const HandEyeMeasurements& m) const {
    return CalibrateHandEye(m.frames, m.joints, kBoard, nominal);
  }
  double Shift_m(const HandEyeCalibration& found) const {
    return (found.X_FC.translation() - truth.tool.X_FC.ToIsometry().translation()).norm();
  }
  double Turn_rad(const HandEyeCalibration& found) const {
    return Eigen::AngleAxisd(found.X_FC.linear().transpose() *
                             truth.tool.X_FC.ToIsometry().linear())
        .angle();
  }
};

TEST_F(HandEyeCalibrated, ComesBackExactlyWithoutNoise) {
  const auto found = Calibrate(MeasureHandEye(truth, kBoard, 12, {0, 0, 0}, stream));
  EXPECT_LT(Shift_m(found), 1e-5);
  EXPECT_LT(Turn_rad(found), 1e-5);
  EXPECT_THAT(found.refused, IsEmpty());
  EXPECT_THAT(found.solvers, SizeIs(6));
}

TEST_F(HandEyeCalibrated, ComesBackWithinTwoMillimetresFromNoisyFrames) {
  for (int i = 0; i < 3; ++i) {
    const auto found = Calibrate(MeasureHandEye(truth, kBoard, 20, {}, stream));
    EXPECT_LT(Shift_m(found), 0.002);
    EXPECT_LT(Turn_rad(found), 0.003);
    EXPECT_LT(found.error.held_out_m, kMaxHeldOut_m);
    EXPECT_GT(found.rotation_spread_rad, kMinRotationSpread_rad);
    for (const HandEyeSolver& solver : found.solvers)
      EXPECT_TRUE(!(solver.held_out_m < found.error.held_out_m)) << solver.name;
  }
}

TEST_F(HandEyeCalibrated, WrongFramesAreNamedAndHaveNoSay) {
  auto measured = MeasureHandEye(truth, kBoard, 20, {}, stream);
  measured.joints[4] = measured.joints[11];  // joints of another picture
  measured.joints[9].rad[1] += 0.02;         // the arm was still moving
  std::swap(measured.frames[13].points[2].id, measured.frames[13].points[20].id);
  const auto found = Calibrate(measured);
  EXPECT_THAT(found.refused,
              ElementsAre(AllOf(HasSubstr("frame_13.png"), HasSubstr("px rms")),
                          AllOf(HasSubstr("frame_04.png"), HasSubstr("mm from where the other")),
                          HasSubstr("frame_09.png")));
  EXPECT_EQ(found.error.poses, 17);
  EXPECT_LT(Shift_m(found), 0.002);
}

TEST_F(HandEyeCalibrated, ManyWrongFramesRefuseTheLot) {
  auto measured = MeasureHandEye(truth, kBoard, 16, {}, stream);
  std::rotate(measured.joints.begin(), measured.joints.begin() + 1, measured.joints.begin() + 6);
  EXPECT_THAT(RefusalOf([&] { Calibrate(measured); }),
              AllOf(HasSubstr("refused"), HasSubstr("of 16 frames had to be left out"),
                    HasSubstr("frame_02.png")));
}

TEST_F(HandEyeCalibrated, TooLittleRotationIsRefusedWithTheFigure) {
  // Turned about the camera's axis alone.
  EXPECT_THAT(
      RefusalOf([&] { Calibrate(MeasureHandEye(truth, kBoard, 12, {}, stream, 0.02)); }),
      AllOf(HasSubstr("second axis"), HasSubstr("at least 0.15")));
  EXPECT_THAT(RefusalOf([&] { Calibrate(MeasureHandEye(truth, kBoard, 5, {}, stream)); }),
              HasSubstr("5 frames can be used; at least 8"));
  auto measured = MeasureHandEye(truth, kBoard, 8, {}, stream);
  measured.joints.pop_back();
  EXPECT_THAT(RefusalOf([&] { Calibrate(measured); }),
              AllOf(HasSubstr("bad input"), HasSubstr("8 frames and 7 joint vectors")));
}

// The board as a camera sees it, by the homography of its plane.
cv::Mat Render(const MarkedFrame& frame) {
  constexpr int kSquare_px = 60;
  const cv::Mat board = DrawBoard(kBoard, kSquare_px);
  std::vector<cv::Point2f> from, to;
  for (const MarkedPoint& point : frame.points) {
    const Eigen::Vector3d p = kBoard.Corners()[static_cast<size_t>(point.id)] / kBoard.square_m;
    // A board's drawing counts pixels from the outer edge of the first.
    from.emplace_back(static_cast<float>(p.x() * kSquare_px - 0.5),
                      static_cast<float>(p.y() * kSquare_px - 0.5));
    to.emplace_back(static_cast<float>(point.pixel.x()), static_cast<float>(point.pixel.y()));
  }
  const cv::Matx33d H = cv::Matx33d(cv::findHomography(from, to));
  cv::Mat large;
  const cv::Matx33d fourfold(4, 0, 1.5, 0, 4, 1.5, 0, 0, 1);
  cv::warpPerspective(board, large, fourfold * H, {4 * 512, 4 * 424}, cv::INTER_AREA,
                      cv::BORDER_CONSTANT, 255);
  cv::Mat grey;
  cv::resize(large, grey, {512, 424}, 0, 0, cv::INTER_AREA);
  return grey;
}

TEST_F(HandEyeCalibrated, PicturesOfTheBoardServe) {
  MeasurementNoise noise;
  noise.pixel = 0;
  const auto measured = MeasureHandEye(truth, kBoard, 12, noise, stream);
  std::filesystem::create_directory("board");
  for (const MarkedFrame& frame : measured.frames) {
    cv::Mat infrared;  // as a Kinect delivers it, 16 bit
    Render(frame).convertTo(infrared, CV_16U, 40);
    cv::imwrite("board/" + frame.name, infrared);
  }
  const auto frames =
      ReadFrames({"board"}, [](const cv::Mat& grey) { return DetectBoard(grey, kBoard); });
  ASSERT_THAT(frames, SizeIs(12));
  EXPECT_EQ(frames[3].name, "frame_03.png");
  const auto found = CalibrateHandEye(frames, measured.joints, kBoard, nominal);
  EXPECT_THAT(found.refused, IsEmpty());
  EXPECT_LT(Shift_m(found), 0.002);
  EXPECT_LT(Turn_rad(found), 0.003);
}

TEST(MarkedFrames, TagsAreFoundByTheirMiddles) {
  // The first white square of a board's top row carries marker 0 in its middle.
  cv::Mat picture;
  cv::copyMakeBorder(DrawBoard(kBoard, 80), picture, 20, 20, 20, 20, cv::BORDER_CONSTANT, 255);
  const auto tags = DetectTags(picture, "4X4_50");
  ASSERT_THAT(tags, SizeIs(17));
  const auto first = std::ranges::find(tags, 0, &MarkedPoint::id);
  ASSERT_NE(first, tags.end());
  EXPECT_LT((first->pixel - Eigen::Vector2d(139.5, 59.5)).norm(), 1);
}

TEST(MarkedFrames, BadInputIsNamed) {
  const auto read = [](const std::string& text) {
    std::ofstream("points.yaml") << text;
    return RefusalOf([] { ReadFrames({"points.yaml"}, nullptr); });
  };
  EXPECT_EQ(read("frames: [{name: a, points: [[0, 1.5, 2.5]]}]"), "accepted");
  EXPECT_THAT(read("frames: [{name: a, points: [[0, 1.5]]}]"),
              AllOf(HasSubstr("frame 1: points"), HasSubstr("3 numbers")));
  EXPECT_THAT(read("frames: [{name: a, points: [[0.5, 1, 2]]}]"), HasSubstr("whole number"));
  EXPECT_THAT(RefusalOf([] { ReadFrames({"none.png"}, nullptr); }), HasSubstr("none.png"));
  EXPECT_EQ(ParseBoard("9x6,0.05,0.04,5X5_100").columns, 9);
  EXPECT_THAT(RefusalOf([] { ParseBoard("9x6,0.04,0.05"); }), HasSubstr("for example 7x5"));
  EXPECT_THAT(RefusalOf([] { ParseBoard("9x6,0.05,0.04,7Z7"); }), HasSubstr("allowed:"));
}

}  // namespace
}  // namespace sandwright
