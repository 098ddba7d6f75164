// A plan: strokes for one terrain in one cell, with seals that say so.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "data/height_map.h"
#include "data/stroke.h"
#include "robot_model/safety_gate.h"

namespace sandwright {

// What a sealed plan was made for. All SHA-256, hexadecimal.
struct PlanSeal {
  std::string blade, workcell, calibration;  // BladeHash, WorkcellHash, CalibrationHash
  std::string terrain;                       // TerrainHash of the scan
  std::string seal;                          // over strokes and the hashes above
};

struct Plan {
  std::vector<Stroke> strokes;
  std::optional<PlanSeal> seal;  // none: made or edited by hand; `check --seal` writes it
};

// Plan file (YAML): schema "sandwright-plan", version 1, frame box. Reading throws Error naming
// file, stroke and key; numbers are written so that they are read back bit for bit.
Plan ReadPlan(const std::filesystem::path& file);
void WritePlan(const Plan& plan, const std::filesystem::path& file);

// Identity of a terrain: grid, datum and heights.
std::string TerrainHash(const HeightMap& terrain);
PlanSeal MakeSeal(const std::vector<Stroke>& strokes, const Workcell& workcell,
                  const HeightMap& terrain);
// Throws Error (kRefused) with every reason: not sealed, edited since, another blade, cell,
// calibration or scan.
void CheckSeal(const Plan& plan, const Workcell& workcell, const HeightMap& terrain,
               const std::string& source);

// Both at once: a plan that is sealed for this cell and scan. Throws as they do.
Plan ReadSealedPlan(const std::filesystem::path& file, const Workcell& workcell,
                    const HeightMap& terrain);

// The gate over a whole plan: each stroke on the terrain as it is now (what
// earlier strokes will do to the sand is known only after the next scan), the
// transfers between them, from and back to home.
struct PlanVerdict {
  bool accepted = false;
  std::vector<std::string> reasons;  // "stroke 2: ..." and "transfer to stroke 3: ..."
  std::vector<GateVerdict> strokes;
  std::vector<TransferVerdict> transfers;  // before each stroke, and the last one home
};
PlanVerdict CheckPlan(const SafetyGate& gate, const std::vector<Stroke>& strokes,
                      const HeightMap& terrain);

// The JSON keys of `check`.
nlohmann::json ToJson(const PlanVerdict& verdict, const Workcell& workcell);

}  // namespace sandwright
