// What the blade itself does to a height map: it cuts the sand it sweeps and lays it over the rupture
// length ahead of it (Reece, "The fundamental equation of earth-moving mechanics", 1965; McKyes 1985).
#pragma once

#include <span>
#include <vector>

#include "data/height_map.h"
#include "data/stroke.h"
#include "env/avalanche.h"

namespace sandwright {

// How sand fails at a blade. The defaults are fitted to strokes through 6 mm grains (docs/sand.md).
struct CutLaw {
  double rupture_ratio = 1.6;  // kappa; theory: 1.8 to 3.5 at 33 degrees, smooth to rough blade
  double spread = 0.62;
  double bite_m = 0.0195;

  void Fields(FieldList& f) {
    f.Add("rupture_ratio", rupture_ratio,
          "length over which cut sand is laid ahead of the blade, over its depth there [1]", 0, 10);
    f.Add("spread", spread, "widening of the laid sand on each side over its distance ahead [1]", 0,
          2);
    f.Add(
        "bite_m", bite_m,
        "how far below its edge the blade drags sand along, at most, and never more than the depth "
        "of sand in front of it; grows with the grains [m]",
        0, 0.1);
  }
};

// Moves one blade over one map, in place. Sand is never lost: what finds no room ahead of the blade
// (walls) stays where it is. Not for several threads at once.
class BladeCut {
 public:
  // `map` must outlive the object. Nothing is cut below `floor_m`.
  BladeCut(HeightMap& map, const Blade& blade, const CutLaw& law, double floor_m);

  // The blade comes down on `pose` from above: its footprint is pushed half ahead, half behind.
  // Returns the cells it changed (indices into height_m; good until the next call).
  std::span<const size_t> Plunge(const BladePose& pose);
  // The blade goes on to `to`, at most about a cell further (its tips too). The same return.
  std::span<const size_t> Advance(const BladePose& from, const BladePose& to);

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
    std::vector<double> bottom;  // down to which the blade takes sand [m]
    std::vector<double> length;  // rupture length [m]
    std::vector<double> room;    // weight of the cells ahead that can take sand
    void Reset(size_t count);
  };
  // A place across the blade: between the middles of two strips.
  struct Between {
    size_t strip, next;
    double share;  // of the next strip
    double Mix(const std::vector<double>& of_strip) const {
      return (1 - share) * of_strip[strip] + share * of_strip[next];
    }
    void Add(double amount, std::vector<double>& of_strip) const {
      of_strip[strip] += (1 - share) * amount;
      of_strip[next] += share * amount;
    }
  };
  struct Receiver {
    size_t cell;
    Between place;
    double weight;
  };

  static Placed Place(const BladePose& pose);
  template <class Visit>
  void ForEachCell(const Placed& at, double u_low, double u_high, double s_half, Visit visit) const;
  double Across(double s) const;
  Between Find(double s) const;
  void Probe(const Placed& at, double side, Strips& strips) const;
  void FindRoom(const Placed& at, double side, Strips& strips,
                std::vector<Receiver>& receivers) const;
  void Lay(const std::vector<Receiver>& receivers, Strips& strips);
  void Cut(const Placed& from, const Placed& to);

  HeightMap& map_;
  CutLaw law_;
  double floor_m_, cell_, half_width_, half_thickness_;
  int strip_count_;
  double strip_width_, per_cell_, per_strip_;
  Strips ahead_, behind_;
  std::vector<size_t> changed_;
  std::vector<Receiver> receivers_ahead_, receivers_behind_;
};

}  // namespace sandwright
