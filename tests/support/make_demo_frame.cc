// make_demo_frame OUT.png: the depth frame that the demo scans. A bed of the
// project's own sand: random dunes, a dozen strokes through them by the heightfield,
// seen by the Kinect model from straight above.
#include <cstdio>

#include "data/excavation.h"
#include "env/depth_camera.h"
#include "env/heightfield.h"
#include "env/terrain_generator.h"

int main(int argc, char** argv) {
  using namespace sandwright;
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_demo_frame OUT.png\n");
    return 2;
  }
  constexpr uint64_t kSeed = 5;
  constexpr double kWidth_m = 1.2, kDepth_m = 0.8, kCell_m = 0.004;
  RandomStream stream(kSeed, StreamId("demo frame"));
  TerrainConfig dunes;
  dunes.mean_depth_m = 0.05;
  dunes.amplitude_m = 0.008;
  dunes.longest_m = 0.3;
  HeightMap bed = GenerateTerrain(dunes, static_cast<int>(kDepth_m / kCell_m + 0.5),
                                  static_cast<int>(kWidth_m / kCell_m + 0.5), kCell_m, stream);
  const Heightfield sand;
  SandState state(std::move(bed));
  for (int i = 0; i < 12; ++i) {
    const Stroke stroke = DrawStroke({}, state.map(), stream);
    sand.Apply({&state, 1}, {&stroke, 1});
  }
  const DepthCamera camera(CameraModel{}, CameraAbove(kWidth_m, kDepth_m, 1.20));
  WriteDepthFrame(camera.Render(state.map(), stream), argv[1]);
  return 0;
}
