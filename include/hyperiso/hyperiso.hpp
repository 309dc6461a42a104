#pragma once
/// \file
/// All of hyperiso. The headers are the manual; start with extract.hpp.

#include "hyperiso/convert.hpp"
#include "hyperiso/extract.hpp"
#include "hyperiso/field.hpp"
#include "hyperiso/grid.hpp"
#include "hyperiso/interval.hpp"
#include "hyperiso/io.hpp"
#include "hyperiso/measure.hpp"
#include "hyperiso/mesh.hpp"
#include "hyperiso/polylines.hpp"
#include "hyperiso/progress.hpp"
#include "hyperiso/result.hpp"
#include "hyperiso/sample.hpp"
#include "hyperiso/seeds.hpp"
#include "hyperiso/slice.hpp"
#include "hyperiso/statistics.hpp"
#include "hyperiso/step_source.hpp"
#include "hyperiso/table.hpp"
#include "hyperiso/track.hpp"
#include "hyperiso/track_files.hpp"
#include "hyperiso/view.hpp"
