#include "render/ray_cast.hpp"

#include "core/parallel.hpp"
#include "mesh/attributes.hpp"
#include "mesh/normals.hpp"

#include <embree3/rtcore.h>
#include <memory>
#include <new>

namespace hyperiso {
namespace {

struct Release {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
template <class Handle>
using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Release>;

template <class T>
T* new_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, std::size_t items) {
  void* buffer = rtcSetNewGeometryBuffer(geometry, type, 0, format, 3 * sizeof(T), items);
  if (!buffer) throw std::bad_alloc();
  return static_cast<T*>(buffer);
}

constexpr Vector plain_outside{143, 179, 217}, plain_inside{217, 176, 138};

// The colours of the surface, before any light.
class Paint {
 public:
  explicit Paint(const Mesh& mesh)
      : mesh_(mesh), channels_(vertex_colours(mesh)), tracks_(track_of_simplices(mesh)) {}

  Vector at(std::size_t triangle, const Vector& weights, bool inside) const {
    if (channels_) {
      Vector colour{};
      for (std::size_t corner = 0; corner < 3; ++corner)
        for (std::size_t k = 0; k < 3; ++k)
          colour[k] += weights[corner] * value_of(*(*channels_)[k], mesh_.simplices[3 * triangle + corner]);
      return colour;
    }
    if (tracks_ && value_of(*tracks_, triangle) >= 0) {
      const Colour colour = label_colour(static_cast<std::int64_t>(value_of(*tracks_, triangle)));
      return {double(colour.red), double(colour.green), double(colour.blue)};
    }
    return inside ? plain_inside : plain_outside;
  }

 private:
  const Mesh& mesh_;
  const std::optional<ColourChannels> channels_;
  const Attribute* const tracks_;
};

class RayCaster {
 public:
  RayCaster(const Mesh& mesh, const Camera& camera, const RenderOptions& options)
      : mesh_(mesh), camera_(camera), options_(options), paint_(mesh), normals_(vertex_normals(mesh)) {
    key_light_ = combined(-0.45, 0.65, 0.65);
    device_.reset(rtcNewDevice(nullptr));
    if (!device_) throw std::bad_alloc();
    scene_.reset(rtcNewScene(device_.get()));
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST); // no ray passes between two triangles
    add_triangles();
    rtcCommitScene(scene_.get());
    if (rtcGetDeviceError(device_.get()) != RTC_ERROR_NONE) throw std::bad_alloc();
  }

  void cast_row(int y, Shaded* row) const {
    constexpr std::array<double, 4> across{0.25, 0.75, 0.25, 0.75}, down{0.25, 0.25, 0.75, 0.75};
    for (int x = 0; x < options_.width; ++x) {
      alignas(16) const int valid[4]{-1, -1, -1, -1};
      RTCRayHit4 rays{};
      std::array<Vector, 4> directions;
      const Vector from = camera_.position();
      for (std::size_t sample = 0; sample < 4; ++sample) {
        directions[sample] = camera_.towards(x + across[sample], y + down[sample]);
        set_ray(rays, sample, from, directions[sample]);
      }
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
      rtcIntersect4(valid, scene_.get(), &context, &rays);
      for (std::size_t sample = 0; sample < 4; ++sample) {
        if (rays.hit.geomID[sample] == RTC_INVALID_GEOMETRY_ID) continue;
        const Vector colour = light(rays.hit.primID[sample], static_cast<double>(rays.hit.u[sample]),
                                    static_cast<double>(rays.hit.v[sample]), directions[sample]);
        for (std::size_t k = 0; k < 3; ++k) row[x].rgb[k] += colour[k];
        row[x].share += 0.25;
      }
      if (row[x].share > 0)
        for (double& channel : row[x].rgb) channel /= 4 * row[x].share;
    }
  }

 private:
  void add_triangles() {
    const Owned<RTCGeometry> geometry(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
    auto* vertices =
        new_buffer<float>(geometry.get(), RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, mesh_.vertex_count());
    for (std::size_t vertex = 0; vertex < mesh_.vertex_count(); ++vertex) {
      const Vector point = corner_at(vertex);
      for (std::size_t k = 0; k < 3; ++k) vertices[3 * vertex + k] = static_cast<float>(point[k]);
    }
    auto* corners =
        new_buffer<unsigned>(geometry.get(), RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, mesh_.simplex_count());
    for (std::size_t corner = 0; corner < mesh_.simplices.size(); ++corner)
      corners[corner] = static_cast<unsigned>(mesh_.simplices[corner]);
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometry(scene_.get(), geometry.get());
  }

  static void set_ray(RTCRayHit4& rays, std::size_t sample, const Vector& from, const Vector& direction) {
    rays.ray.org_x[sample] = static_cast<float>(from[0]);
    rays.ray.org_y[sample] = static_cast<float>(from[1]);
    rays.ray.org_z[sample] = static_cast<float>(from[2]);
    rays.ray.dir_x[sample] = static_cast<float>(direction[0]);
    rays.ray.dir_y[sample] = static_cast<float>(direction[1]);
    rays.ray.dir_z[sample] = static_cast<float>(direction[2]);
    rays.ray.tfar[sample] = HUGE_VALF;
    rays.ray.mask[sample] = ~0u;
    rays.hit.geomID[sample] = RTC_INVALID_GEOMETRY_ID;
  }

  Vector corner_at(std::size_t vertex) const {
    return camera_.near_origin(
        {mesh_.positions[3 * vertex], mesh_.positions[3 * vertex + 1], mesh_.positions[3 * vertex + 2]});
  }

  // The light that comes from a point of a triangle against the direction of a ray.
  Vector light(std::size_t triangle, double u, double v, const Vector& direction) const {
    const Vector weights{1 - u - v, u, v};
    std::array<Vector, 3> corners;
    Vector normal{};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::size_t vertex = mesh_.simplices[3 * triangle + corner];
      corners[corner] = corner_at(vertex);
      for (std::size_t k = 0; k < 3; ++k)
        normal[k] += weights[corner] * static_cast<double>(normals_[3 * vertex + k]);
    }
    const bool inside = dot(triangle_normal(corners), direction) > 0; // its outer side looks away
    normal = unit(normal);
    if (inside)
      for (double& component : normal) component = -component;

    const Vector back{-direction[0], -direction[1], -direction[2]};
    Vector between;
    for (std::size_t k = 0; k < 3; ++k) between[k] = key_light_[k] + back[k];
    const double diffuse = std::max(0.0, dot(normal, key_light_)), facing = std::max(0.0, dot(normal, back));
    const double ambient = 0.30 + 0.06 * dot(normal, camera_.up);
    const double strength = ambient + 0.52 * diffuse + 0.2 * facing;
    const double gloss = inside ? 0 : 36 * std::pow(std::max(0.0, dot(normal, unit(between))), 40);
    Vector colour = paint_.at(triangle, weights, inside);
    for (double& channel : colour) channel = std::clamp(channel * strength + gloss, 0.0, 255.0);
    return colour;
  }

  Vector combined(double along_right, double along_up, double along_back) const {
    Vector sum;
    for (std::size_t k = 0; k < 3; ++k)
      sum[k] = along_right * camera_.right[k] + along_up * camera_.up[k] + along_back * camera_.back[k];
    return unit(sum);
  }

  const Mesh& mesh_;
  const Camera& camera_;
  const RenderOptions& options_;
  Paint paint_;
  std::vector<float> normals_;
  Vector key_light_;
  Owned<RTCDevice> device_;
  Owned<RTCScene> scene_;
};

} // namespace

std::vector<Shaded> cast_rays(const Mesh& mesh, const Camera& camera, const RenderOptions& options) {
  const auto width = static_cast<std::size_t>(options.width);
  std::vector<Shaded> pixels(width * static_cast<std::size_t>(options.height));
  if (mesh.simplex_count() == 0) return pixels;
  const RayCaster caster(mesh, camera, options);
  share_out(worker_count(options.threads), static_cast<std::size_t>(options.height),
            [&](int, std::size_t row) { caster.cast_row(static_cast<int>(row), &pixels[row * width]); });
  return pixels;
}

} // namespace hyperiso
