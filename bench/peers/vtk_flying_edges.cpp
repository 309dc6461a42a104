#include "peers.hpp"

#include "clock.hpp"

#include <algorithm>
#include <cmath>
#ifdef HYPERISO_BENCH_VTK
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSMPTools.h>
#endif

namespace hyperiso::bench {

std::optional<double> vtk_flying_edges_seconds([[maybe_unused]] const Volume& volume,
                                               [[maybe_unused]] double isovalue,
                                               [[maybe_unused]] int threads) {
#ifdef HYPERISO_BENCH_VTK
  vtkSMPTools::SetBackend("STDThread");
  vtkSMPTools::Initialize(threads);
  const auto [nx, ny, nz] = volume.dims;
  vtkNew<vtkFloatArray> samples;
  samples->SetArray(const_cast<float*>(volume.samples), vtkIdType{nx} * ny * nz, 1); // read only
  vtkNew<vtkImageData> image;
  image->SetDimensions(nx, ny, nz);
  image->GetPointData()->SetScalars(samples);
  double best = HUGE_VAL;
  const Clock all;
  for (int run = 0; run < 20 && (run < 2 || all.seconds() < 3); ++run) {
    vtkNew<vtkFlyingEdges3D> filter;
    filter->SetInputData(image);
    filter->SetValue(0, isovalue);
    filter->ComputeNormalsOff();
    filter->ComputeGradientsOff();
    filter->ComputeScalarsOff();
    const Clock clock;
    filter->Update();
    best = std::min(best, clock.seconds());
  }
  return best;
#else
  return std::nullopt;
#endif
}

} // namespace hyperiso::bench
