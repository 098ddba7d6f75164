// Distances in the cell: links, camera and blade holder to walls, table, sand and each other.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "robot_model/arm_model.h"

namespace sandwright {

// The MuJoCo model with the pairs that can meet, shared by all threads; each thread leases an
// mjData. The blade's plate is compared with the arm and the pedestal only: walls, floor and sand
// are its working place and checked by its path.
class ClearanceModel {
 public:
  explicit ClearanceModel(const Workcell& workcell);

  struct Nearest {
    double distance_m;
    std::string between;  // "forearm_tube and wall_2"; "" where nothing is within sight
  };

  // Exclusive use of one mjData while it lives.
  class Lease {
   public:
    explicit Lease(const ClearanceModel& model);
    ~Lease();
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;

    // Smallest distance of all pairs at the joint angles, `seen_m` where all are farther.
    Nearest At(const JointAngles& q, double seen_m);
    // Smallest height of links and camera above a sand level in the box [m above the box floor], of
    // those that are over the box; after At() for the same joint angles.
    double AboveSand(double sand_top_m, double seen_m) const;

   private:
    const ClearanceModel& model_;
    MujocoData data_;
  };

 private:
  struct Pair {
    int a, b;  // geoms; b is a box where `b_is_box`
    bool b_is_box;
  };
  // A bound from below that costs little.
  double AtLeast(const Pair& pair, const mjData& data) const;

  MujocoModel model_;
  Eigen::Isometry3d X_BW_;
  double width_m_, depth_m_;
  std::vector<Pair> pairs_;
  std::vector<int> over_sand_;
  mutable std::mutex mutex_;
  mutable std::vector<MujocoData> idle_;
};

}  // namespace sandwright
