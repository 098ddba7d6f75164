// What a training run leaves on disk, beside its log.
#pragma once

#include <filesystem>

#include "env/safetensors.h"

namespace sandwright {

// Makes the folder and its checkpoints/; Error where that cannot be.
void MakeRunFolder(const std::filesystem::path& folder);

// Keeps the last three.
void WriteCheckpoint(const Safetensors& content, int64_t steps,
                     const std::filesystem::path& folder);
bool HasCheckpoint(int64_t steps, const std::filesystem::path& folder);

// The last checkpoint of a run folder; Error where there is none.
std::filesystem::path LastCheckpoint(const std::filesystem::path& folder);

}  // namespace sandwright
