// A cell from above: what stands where, what the arm reaches, what the camera sees.
#pragma once

#include <opencv2/core.hpp>

#include "robot_model/safety_gate.h"

namespace sandwright {

// Share of the box floor that the camera sees from one of its poses: within its picture, and not
// behind a wall's rim. On a grid of 10 mm.
double CameraCoverage(const Workcell& workcell);

// Plan view along -z of B, x to the right, to scale: the box and the share of headings in which the
// arm can start strokes, the outlines of the camera's pictures on the box floor, the frames W, B, F (at
// home), T and C (at the first camera pose), each with its axes and its height in B; below, what the colours
// mean and whether the cell is calibrated. BGR.
cv::Mat DrawWorkcell(const SafetyGate& gate);

}  // namespace sandwright
