#pragma once
// Fields that are read step by step, because they do not fit into memory or because nobody needs the whole.

#include "hyperiso/stream.hpp"

namespace hyperiso::cli {

// Bytes of one step.
std::uint64_t step_bytes(const FieldInfo& info);

// Whether `stream` can extract it: by its method and dimension, and if it has steps.
bool can_stream(const FieldInfo& info, const ExtractOptions& options);

// `memory_left` without two steps of the field. Fails if that is nothing.
std::uint64_t memory_beside_steps(const FieldInfo& info, std::uint64_t memory_left);

// The surface of a field that is read step by step. Within `options.memory_limit`.
Result<Mesh> collect_surface(StepSource& steps, double isovalue, const ExtractOptions& options);

} // namespace hyperiso::cli
