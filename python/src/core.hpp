// What the files of the module share: poses as arrays, one user of an object at a time, HDF5 one at a time.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <atomic>
#include <mutex>
#include <string>

#include "snug/spatial/pose.hpp"

namespace snug::python {

namespace py = pybind11;
using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// [x, y, z, qw, qx, qy, qz], m; qw >= 0.
void write_pose(const Pose& X, double* out);
[[nodiscard]] Array as_array(const Pose& X);
[[nodiscard]] Array as_array(const Vector3& v);
[[nodiscard]] Array as_array(const Vector6& v);
[[nodiscard]] Array as_array(const Matrix6& m);
/// From seven numbers or a 4 x 4 matrix. Throws InputError naming `what`.
[[nodiscard]] Pose as_pose(const Array& array, const char* what);
[[nodiscard]] Vector3 as_vector3(const Array& array, const char* what);

/// A read-only array onto memory that `owner` keeps alive and never moves.
[[nodiscard]] py::array view(const py::object& owner, const py::dtype& type, const void* data,
                             std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides);

/// JSON text as Python objects.
[[nodiscard]] py::object from_json(const std::string& text);

/// Marks an object as being used while the interpreter's lock is released; a second user is refused.
class Use {
 public:
  explicit Use(std::atomic<bool>& busy);
  ~Use() { busy_ = false; }
  Use(const Use&) = delete;
  Use& operator=(const Use&) = delete;

 private:
  std::atomic<bool>& busy_;
};

/// HDF5 is not thread-safe: whoever uses it releases the interpreter's lock first, then holds this.
struct HdfUse {
  HdfUse();
  py::gil_scoped_release release;
  std::unique_lock<std::recursive_mutex> lock;
};

/// Properties `positions`, `quaternions`, `velocities`, `angular_velocities`, `present` of a class that steps a world,
/// and what else all such classes have. `Self` has world(), model() and state().
template <class Self, class... More>
void add_bodies(py::class_<Self, More...>& type);

void bind_scenario(py::module_& m);
void bind_world(py::module_& m);
void bind_tools(py::module_& m);
void bind_packing(py::module_& m);
void bind_session(py::module_& m);
void bind_environment(py::module_& m);

}  // namespace snug::python
