#include "extract/workspace.hpp"

namespace hyperiso {

Workspace::Workspace() : state_(std::make_unique<State>()) {}
Workspace::Workspace(Workspace&&) noexcept = default;
Workspace& Workspace::operator=(Workspace&&) noexcept = default;
Workspace::~Workspace() = default;

FieldRanges::FieldRanges() : state_(std::make_unique<State>()) {}
FieldRanges::FieldRanges(FieldRanges&&) noexcept = default;
FieldRanges& FieldRanges::operator=(FieldRanges&&) noexcept = default;
FieldRanges::~FieldRanges() = default;
void FieldRanges::clear() { state_->complete = false; }

} // namespace hyperiso
