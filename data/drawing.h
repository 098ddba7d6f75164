// Drawings in grey: what a goal takes its relief from.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

namespace sandwright {

// A grey picture file of 8 or 16 bits as CV_32F [rows x columns], row 0 at the top: 0 black to 1
// white. Throws Error naming the file where it is missing or no picture, has colour or
// transparency, or is all one grey.
cv::Mat ReadDrawing(const std::filesystem::path& file);

// `text` in OpenCV's Hershey font, white on black, as large as fits with its lines `line_px` wide and
// that far from the edges. CV_32F of 0 and 1. Throws Error where no letter of it fits.
cv::Mat DrawLetters(const std::string& text, int rows, int columns, int line_px);

}  // namespace sandwright
