#include "cli/collect_on_rig.h"

#include "data/base/error.h"
#include "data/shipped.h"

namespace sandwright {

Deployment CollectOnRig(DeployRequest request, DeploySettings settings,
                        const CollectConfig& config, RunStatus* status) {
  namespace fs = std::filesystem;
  const fs::path folder = request.log;
  if (request.workcell.empty()) request.workcell = ShippedConfig("workcell.yaml").string();
  request.mode = "run";
  request.resume = RigLog::Exists(folder);
  settings.excavation = config.excavation;
  settings.deployment.scan.cell_size_m = config.cell_size_m;
  if (request.arm != "simulated") return RunDeploy(request, settings, status);
  const fs::path bed = folder / "terrain.h5";
  request.terrain = bed.string();
  if (!fs::exists(bed)) {
    const BoxSettings box = LoadWorkcell(request.workcell).box;
    RandomStream stream(request.seed, StreamId("bed"));
    fs::create_directories(folder);
    WriteHeightMap(GenerateTerrain(config.terrain,
                                   WholeCells(box.depth_m, config.cell_size_m, "cell_size_m"),
                                   WholeCells(box.width_m, config.cell_size_m, "cell_size_m"),
                                   config.cell_size_m, stream),
                   bed);
  }
  return RunDeploy(request, settings, status);
}

}  // namespace sandwright
