#include "aras_visual_servo_common/ros/yaml_from_xmlrpc.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "aras_visual_servo_common/yaml_value.hpp"

namespace aras_visual_servo_common::yaml_from_xmlrpc_test {
namespace {

TEST(YamlFromXmlRpc, KeepsEveryTypeAndEveryBit) {
  XmlRpc::XmlRpcValue value;
  value["truth"] = XmlRpc::XmlRpcValue(true);
  value["count"] = -3;
  value["third"] = 1.0 / 3.0;
  value["tenth"] = 0.1;
  value["text"] = "1";
  value["list"][0] = 1;
  value["list"][1] = 2.5;
  value["map"]["inner"] = "word";
  const YAML::Node node = yamlFromXmlRpc(value);
  EXPECT_TRUE(boolOf(node["truth"]).value());
  EXPECT_EQ(integerOf(node["count"]), -3);
  EXPECT_EQ(numberOf(node["third"]), 1.0 / 3.0);
  EXPECT_EQ(node["tenth"].Scalar(), "0.1");
  EXPECT_FALSE(numberOf(node["text"]).has_value());
  EXPECT_EQ(node["text"].as<std::string>(), "1");
  ASSERT_EQ(node["list"].size(), 2u);
  EXPECT_EQ(numberOf(node["list"][1]), 2.5);
  EXPECT_EQ(node["map"]["inner"].Scalar(), "word");
}

TEST(YamlFromXmlRpc, NumbersThatAreNotFiniteStayNumbers) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(numberOf(yamlFromXmlRpc(XmlRpc::XmlRpcValue(-infinity))), -infinity);
  EXPECT_TRUE(std::isnan(numberOf(yamlFromXmlRpc(XmlRpc::XmlRpcValue(std::nan("")))).value()));
}

TEST(YamlFromXmlRpc, NothingIsNull) { EXPECT_TRUE(yamlFromXmlRpc(XmlRpc::XmlRpcValue()).IsNull()); }

}  // namespace
}  // namespace aras_visual_servo_common::yaml_from_xmlrpc_test
