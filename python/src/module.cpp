// The module snug._core: errors, arrays, and its parts.
#include <cstring>
#include <nlohmann/json.hpp>

#include "core.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/output_file.hpp"
#include "snug/record/hdf5_lock.hpp"

namespace snug::python {
namespace {

/// "file:12" as ("file", 12); without a line ("file", None).
std::pair<std::string, py::object> split_where(const std::string& where) {
  const std::size_t colon = where.rfind(':');
  if (colon == std::string::npos || colon + 1 == where.size()) return {where, py::none()};
  for (std::size_t i = colon + 1; i < where.size(); ++i) {
    if (where[i] < '0' || where[i] > '9') return {where, py::none()};
  }
  if (where.size() - colon > 10) return {where, py::none()};
  return {where.substr(0, colon), py::int_(std::stol(where.substr(colon + 1)))};
}

void raise_input_error(const py::object& type, const InputError& error) {
  py::object instance = type(error.what());
  const auto [file, line] = split_where(error.where);
  instance.attr("file") = file;
  instance.attr("line") = line;
  instance.attr("key") = error.key;
  instance.attr("got") = error.got;
  instance.attr("expected") = error.expected;
  PyErr_SetObject(type.ptr(), instance.ptr());
}

Array copied(const double* data, std::vector<py::ssize_t> shape) { return Array(std::move(shape), data); }

}  // namespace

void write_pose(const Pose& X, double* out) {
  Quaternion q(X.R);
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  const double numbers[7] = {X.p.x(), X.p.y(), X.p.z(), q.w(), q.x(), q.y(), q.z()};
  std::memcpy(out, numbers, sizeof numbers);
}

Array as_array(const Pose& X) {
  Array array(7);
  write_pose(X, array.mutable_data());
  return array;
}
Array as_array(const Vector3& v) { return copied(v.data(), {3}); }
Array as_array(const Vector6& v) { return copied(v.data(), {6}); }
Array as_array(const Matrix6& m) {
  const Eigen::Matrix<double, 6, 6, Eigen::RowMajor> rows = m;
  return copied(rows.data(), {6, 6});
}

Vector3 as_vector3(const Array& array, const char* what) {
  if (array.size() != 3) throw InputError("argument", what, std::to_string(array.size()) + " numbers", "three numbers");
  const Vector3 v(array.data()[0], array.data()[1], array.data()[2]);
  if (!v.allFinite()) throw InputError("argument", what, "a number that is not finite", "finite numbers");
  return v;
}

Pose as_pose(const Array& array, const char* what) {
  const double* const d = array.data();
  for (py::ssize_t i = 0; i < array.size(); ++i) {
    if (!std::isfinite(d[i])) throw InputError("argument", what, "a number that is not finite", "finite numbers");
  }
  if (array.ndim() == 1 && array.size() == 7) {
    const Quaternion q(d[3], d[4], d[5], d[6]);
    if (std::abs(q.norm() - 1.0) > 1e-6)
      throw InputError("argument", what, "a quaternion of length " + std::to_string(q.norm()), "a unit quaternion");
    return {q.normalized().toRotationMatrix(), Vector3(d[0], d[1], d[2])};
  }
  if (array.ndim() == 2 && array.shape(0) == 4 && array.shape(1) == 4) {
    Pose X;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) X.R(r, c) = d[4 * r + c];
      X.p[r] = d[4 * r + 3];
    }
    if (!(X.R * X.R.transpose()).isIdentity(1e-6) || X.R.determinant() < 0.0)
      throw InputError("argument", what, "a matrix that is no rotation", "an orthonormal right-handed matrix");
    X.R = orthonormalized(X.R);
    return X;
  }
  throw InputError("argument", what, "an array of another shape",
                   "7 numbers [x, y, z, qw, qx, qy, qz], or a 4 x 4 matrix");
}

py::array view(const py::object& owner, const py::dtype& type, const void* data, std::vector<py::ssize_t> shape,
               std::vector<py::ssize_t> strides) {
  py::array array(type, std::move(shape), std::move(strides), data, owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

py::object from_json(const std::string& text) { return py::module_::import("json").attr("loads")(text); }

Use::Use(std::atomic<bool>& busy) : busy_(busy) {
  if (busy_.exchange(true)) throw std::runtime_error("this object is in use by another thread: one at a time");
}

HdfUse::HdfUse() : lock(record::lock_hdf5()) {}

}  // namespace snug::python

PYBIND11_MODULE(_core, m) {
  using namespace snug::python;
  m.doc() = "Compiled part of snug; import snug instead.";
  m.attr("__version__") = SNUG_VERSION;
  // The class lives in Python, where its attributes can be declared; the module is told of it when it is imported.
  m.def("set_input_error", [](const py::object& type) {
    static PyObject* known = nullptr;
    known = type.inc_ref().ptr();
    py::register_local_exception_translator([](std::exception_ptr p) {
      try {
        if (p) std::rethrow_exception(p);
      } catch (const snug::InputError& error) {
        raise_input_error(py::reinterpret_borrow<py::object>(known), error);
      } catch (const snug::OutputError& error) {
        PyErr_SetString(PyExc_OSError, error.what());
      }
    });
  });
  m.def(
      "as_pose", [](const Array& transform) { return as_array(as_pose(transform, "transform")); },
      py::arg("transform"));
  bind_scenario(m);
  bind_world(m);
  bind_tools(m);
  bind_packing(m);
  bind_session(m);
  bind_environment(m);
}
