#pragma once
// One workload: a sample field and how it is extracted. Each file of workloads/ adds some to the table.

#include "hyperiso/extract.hpp"

#include <string>
#include <vector>

namespace hyperiso::bench {

struct Workload {
  std::string title;
  std::string sample; // name of the built-in field
  std::vector<std::int64_t> dims;
  SampleType type = SampleType::f32;
  int blobs = 2;
  Method method = Method::hull;
  double isovalue = -1; // -1: the one that shows the field's shape
  bool peers = false;   // time the cell loop, and what others do the same job
};

// Adds the workload to the table, on one thread and on all. Returns 0.
int add_workload(Workload workload);

} // namespace hyperiso::bench
