// What the blade itself does to a height map: it cuts the sand it sweeps and lays it over the rupture
// length ahead of it (Reece, "The fundamental equation of earth-moving mechanics", 1965; McKyes 1985).
#pragma once

#include <vector>

#include "data/height_map.h"
#include "data/stroke.h"
#include "env/avalanche.h"

namespace sandwright {

// Moves one blade over one map, in place. Sand is never lost: what finds no room ahead of the blade
// (walls) stays where it is. Not for several threads at once.
class BladeCut {
 public:
  // `rupture_ratio`: length over which cut sand is laid ahead of the blade, as a multiple of the
  // depth of the sand in front of it (kappa; 1.8-4 for dry sand). `map` must outlive the object.
  BladeCut(HeightMap& map, const Blade& blade, double rupture_ratio);

  // The blade comes down on `pose` from above: its footprint is pushed half ahead, half behind.
  // Returns the cells that may have changed (empty: nothing was cut).
  CellRect Plunge(const BladePose& pose);
  // The blade goes on to `to`, at most about a cell further (its tips too). The same return.
  CellRect Advance(const BladePose& from, const BladePose& to);

  // Faces that the blade's front closes at `pose`: where it stands in sand.
  std::vector<CellFace> ClosedFaces(const BladePose& pose) const;

 private:
  // The blade at a pose: cosine and sine of its heading.
  struct Placed {
    BladePose pose;
    double c, s;
  };
  // Strips across the blade; cut sand stays in its strip until it is laid down.
  struct Strips {
    std::vector<double> volume;  // cut and waiting, heights summed over cells [m]
    std::vector<double> length;  // rupture length [m]
    std::vector<double> room;    // weight of the cells ahead that can take sand
    void Reset(size_t count);
  };
  struct Receiver {
    size_t cell;
    int strip;      // and the next one
    double share;   // of the next strip
    double weight;
  };

  static Placed Place(const BladePose& pose);
  template <class Visit>
  void ForEachCell(const Placed& at, double u_low, double u_high, double s_half, Visit visit) const;
  double Across(double s) const;
  void Sample(double s, int& strip, double& share) const;
  void FindRoom(const Placed& at, double side, Strips& strips, std::vector<Receiver>& receivers) const;
  CellRect Lay(const std::vector<Receiver>& receivers, Strips& strips);
  CellRect Cut(const Placed& from, const Placed& to);

  HeightMap& map_;
  double cell_, half_width_, half_thickness_, rupture_ratio_;
  int strip_count_;
  double strip_width_;
  Strips ahead_, behind_;
  std::vector<Receiver> receivers_ahead_, receivers_behind_;
};

}  // namespace sandwright
