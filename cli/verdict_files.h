// A verdict (agents/verdict.h) made, written and compared for the subcommands.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "agents/verdict.h"
#include "env/sand_model_by_name.h"

namespace sandwright {

// The sand models of config.worlds, in order.
std::vector<std::unique_ptr<SandModel>> LoadWorlds(const VerdictConfig& config, const SandModelConfig& sand);

// For CLI11: what is wrong with the name of a verdict's file; "": nothing.
std::string IsVerdictFile(const std::string& file);
// FILE (JSON, what is returned), beside it the picture, .png, and in words on standard output. Throws Error where
// making the verdict was stopped.
nlohmann::json WriteVerdict(const Verdict& verdict, const ShapingJob& job, const VerdictConfig& config,
                            const std::string& file);

// Throws Error where it is no verdict, or of another goal.
nlohmann::json ReadVerdict(const std::string& file, const HeightMap& goal);

// "expected 2.9 mm, 2.1 to 4.0 mm in nine of ten; 12 strokes, 2.7 minutes"
std::string VerdictInWords(const nlohmann::json& verdict);
// "2.4 mm lies inside the 2.1 to 4.0 mm that were foreseen"; of CompareWithVerdict's.
std::string OutcomeInWords(const nlohmann::json& outcome);

}  // namespace sandwright
