#include "env/kernel_density.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace sandwright {
namespace {

TEST(KernelDensity, ModeOfOneOfEqualAndOfManyValues) {
  const std::vector<double> one = {2.5}, equal = {1, 1, 1}, many = {1.0, 1.1, 0.9, 1.05, 4, 7};
  EXPECT_DOUBLE_EQ(KernelDensity(one).Mode(), 2.5);
  EXPECT_DOUBLE_EQ(KernelDensity(equal).Mode(), 1);
  EXPECT_DOUBLE_EQ(KernelDensity(equal).bandwidth(), 0);
  EXPECT_NEAR(KernelDensity(many).Mode(), 1.05, 0.3);
}

TEST(KernelDensity, HasUnitAreaAndSilvermansWidth) {
  const std::vector<double> values = {1, 2, 3, 4, 5};  // deviation 1.581, quartiles 2 apart
  const KernelDensity density(values);
  EXPECT_NEAR(density.bandwidth(), 0.9 * (2 / 1.34) * std::pow(5, -0.2), 1e-12);
  double area = 0;
  for (double x = -10; x < 16; x += 0.01) area += 0.01 * density.At(x);
  EXPECT_NEAR(area, 1, 1e-6);
}

}  // namespace
}  // namespace sandwright
