#include "data/drawing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "data/base/atomic_file.h"
#include "data/base/error.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::string Temp(const std::string& name) { return ::testing::TempDir() + name; }

std::string Written(const std::string& name, const cv::Mat& image) {
  cv::imwrite(Temp(name), image);
  return Temp(name);
}

auto Fails(const std::string& text) { return ThrowsMessage<Error>(HasSubstr(text)); }

TEST(Drawing, GreyOfEightAndSixteenBitsIsZeroToOne) {
  const cv::Mat eight = (cv::Mat_<uchar>(2, 2) << 0, 51, 255, 102);
  const cv::Mat read = ReadDrawing(Written("eight.png", eight));
  EXPECT_EQ(read.type(), CV_32F);
  EXPECT_FLOAT_EQ(read.at<float>(0, 1), 0.2f);  // row 0 is the top
  EXPECT_FLOAT_EQ(read.at<float>(1, 0), 1);
  const cv::Mat sixteen = (cv::Mat_<uint16_t>(1, 3) << 0, 13107, 65535);
  EXPECT_FLOAT_EQ(ReadDrawing(Written("sixteen.png", sixteen)).at<float>(0, 1), 0.2f);
}

TEST(Drawing, WhatIsNoDrawingIsNamed) {
  EXPECT_THAT([] { ReadDrawing("missing.png"); }, Fails("missing.png: no such file"));
  WriteFileAtomically(Temp("text.png"), "words");
  EXPECT_THAT([] { ReadDrawing(Temp("text.png")); }, Fails("text.png: not a picture"));
  cv::Mat colour(4, 4, CV_8UC3, cv::Scalar(0, 0, 0)), alpha(4, 4, CV_8UC4, cv::Scalar(0, 0, 0, 9));
  colour.at<cv::Vec3b>(1, 1) = {9, 9, 9};
  alpha.at<cv::Vec4b>(1, 1) = {9, 9, 9, 0};
  EXPECT_THAT([&] { ReadDrawing(Written("colour.png", colour)); },
              Fails("colour.png: a drawing is grey, without transparency; this has 3 channels"));
  EXPECT_THAT([&] { ReadDrawing(Written("alpha.png", alpha)); }, Fails("this has 4 channels"));
  EXPECT_THAT([] { ReadDrawing(Written("empty.png", cv::Mat(4, 4, CV_8U, cv::Scalar(51)))); },
              Fails("empty.png: the drawing is empty: all of it is one grey (0.200)"));
}

TEST(Drawing, LettersFillTheirPictureButForOneLine) {
  for (const char* text : {"I", "W", "SAND"}) {
    SCOPED_TRACE(text);
    const cv::Mat image = DrawLetters(text, 240, 400, 12);
    cv::Mat bytes;
    image.convertTo(bytes, CV_8U);
    const cv::Rect box = cv::boundingRect(bytes);
    EXPECT_GE(std::min({box.x, box.y, 400 - box.br().x, 240 - box.br().y}), 8);
    // As large as fits: one of the two extents is used but for about a line at both ends.
    EXPECT_TRUE(box.width > 400 - 60 || box.height > 240 - 40) << box;
    EXPECT_GT(cv::countNonZero(bytes), 12 * std::max(box.width, box.height) / 2);
  }
  EXPECT_THAT([] { DrawLetters("AB", 30, 30, 12); }, Fails("\"AB\" does not fit into 30 x 30"));
}

}  // namespace
}  // namespace sandwright
