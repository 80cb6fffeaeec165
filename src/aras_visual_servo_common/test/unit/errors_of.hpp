#pragma once

#include <gtest/gtest.h>

#include <string>

#include "aras_visual_servo_common/errors.hpp"

/** The text of the Error that an action throws; empty when it throws none. */
template <typename Error, typename Action>
std::string textOf(Action&& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

#define EXPECT_HAS(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)
#define EXPECT_HAS_NOT(text, part) EXPECT_EQ((text).find(part), std::string::npos) << (text)
