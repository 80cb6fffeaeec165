#include "aras_visual_servo_common/python/yaml_from_python.hpp"

#include <pybind11/embed.h>

#include "aras_visual_servo_common/python/bind_errors.hpp"
#include "aras_visual_servo_common/yaml_value.hpp"
#include "errors_of.hpp"

namespace py = pybind11;

namespace aras_visual_servo_common::yaml_from_python_test {
namespace {

PYBIND11_EMBEDDED_MODULE(toy_module, module) {
  bindErrors(module);
  module.def("refuse", [] { throw ParameterError("a: found 1, allowed 2"); });
  module.def("refuse_shape", [] { throw ShapeError("3 of them"); });
  module.def("refuse_anyhow", [] { throw ArasError("no"); });
}

/** One interpreter for all tests: it cannot be started twice. */
class Python : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { interpreter_ = std::make_unique<py::scoped_interpreter>(); }
  static void TearDownTestSuite() { interpreter_.reset(); }

 private:
  inline static std::unique_ptr<py::scoped_interpreter> interpreter_;
};

TEST_F(Python, ValuesKeepTheirTypeAndEveryBit) {
  const YAML::Node node = yamlFromPython(
      py::eval(
          "{'truth': True, 'count': -3, 'third': 1 / 3, 'tenth': 0.1, 'text': '1', 'none': None, 'list': [1, 2.5], "
          "'tuple': ('a',), 'map': {'inner': 'word'}, 'far': float('inf'), 'back': float('-inf'), "
          "'off': False}"),
      "toy");
  EXPECT_TRUE(boolOf(node["truth"]).value());
  EXPECT_EQ(integerOf(node["count"]), -3);
  EXPECT_EQ(numberOf(node["third"]), 1.0 / 3.0);
  EXPECT_EQ(node["tenth"].Scalar(), "0.1");
  EXPECT_FALSE(numberOf(node["text"]).has_value());
  EXPECT_TRUE(node["none"].IsNull());
  EXPECT_EQ(numberOf(node["list"][1]), 2.5);
  EXPECT_EQ(node["tuple"][0].Scalar(), "a");
  EXPECT_EQ(node["map"]["inner"].Scalar(), "word");
  EXPECT_EQ(numberOf(node["far"]), std::numeric_limits<double>::infinity());
  EXPECT_EQ(numberOf(node["back"]), -std::numeric_limits<double>::infinity());
  EXPECT_FALSE(boolOf(node["off"]).value());
}

TEST_F(Python, NumpyIsReadAsNumbersAndLists) {
  py::exec("import numpy");
  EXPECT_EQ(numberOf(yamlFromPython(py::eval("numpy.float32(0.5)"), "toy")), 0.5);
  EXPECT_EQ(integerOf(yamlFromPython(py::eval("numpy.eye(3)"), "toy")[2][2]), 1);
}

TEST_F(Python, WhatYamlDoesNotHaveIsRefusedWithItsPlace) {
  const py::object value = py::eval("{'a': [{1, 2}]}");
  EXPECT_HAS(textOf<ParameterError>([&] { yamlFromPython(value, "toy"); }), "toy.a[]: found <class 'set'>, allowed");
}

TEST_F(Python, ErrorsAreThoseOfTheModuleAndOfOneFamily) {
  py::exec(R"(
import toy_module
def raised(function):
    try:
        function()
    except RuntimeError as error:
        return error
parameter, shape, other = map(raised, (toy_module.refuse, toy_module.refuse_shape, toy_module.refuse_anyhow))
assert type(parameter) is toy_module.ParameterError and str(parameter) == "a: found 1, allowed 2"
assert type(shape) is toy_module.ShapeError and type(other) is toy_module.ArasError
assert all(isinstance(error, toy_module.ArasError) for error in (parameter, shape, other))
)");
}

}  // namespace
}  // namespace aras_visual_servo_common::yaml_from_python_test
