// Contexts: every backend of the build opens, knows its version, and two may live in one thread.
#include "brink/core/fields/gl_context.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <thread>

#include "brink/core/base/error.h"
#include "brink/core/fields/field_options.h"

namespace brink::gl_context_test {
namespace {

TEST(GlContext, EveryBackendOfTheBuildOpens) {
  ASSERT_FALSE(gl_backends().empty());
  for (const auto name : gl_backends()) {
    const auto context = open_gl_context(name);
    EXPECT_EQ(context->backend(), name);
    EXPECT_NE(context->description().find("OpenGL"), std::string::npos);
    EXPECT_NE(context->function("glDrawArraysInstanced"), nullptr);
  }
  EXPECT_EQ(open_gl_context("auto")->backend(), gl_backends().front());
}

TEST(GlContext, UnknownBackendIsRefusedByName) {
  try {
    open_gl_context("vulkan");
    FAIL() << "no exception";
  } catch (const BadInput& e) {
    EXPECT_NE(std::string(e.what()).find("vulkan"), std::string::npos);
    EXPECT_NE(std::string(e.what()).find("osmesa"), std::string::npos);
  }
}

// The level is a promise about what is used, whatever Mesa really offers.
TEST(GlContext, OldLevelDeclaresNoStorageBuffers) {
  EXPECT_FALSE(open_gl_context("auto", GlLevel::only_33)->has_storage_buffers());
}

TEST(GlContext, DrawingThreadsAreOffUnlessTheUserChose) {
  open_gl_context();
  EXPECT_NE(std::getenv("LP_NUM_THREADS"), nullptr);
}

TEST(GlContext, ThreadsHaveTheirOwn) {
  const auto mine = open_gl_context();
  std::string theirs;
  std::thread([&] {
    const auto context = open_gl_context();
    context->make_current();
    theirs = context->description();
  }).join();
  EXPECT_EQ(theirs, mine->description());
}

TEST(FieldOptions, DefaultsAreValid) {
  std::string error;
  EXPECT_TRUE(FieldOptions().is_valid(&error)) << error;
}

TEST(FieldOptions, BadValuesAreNamed) {
  const auto message = [](auto change) {
    FieldOptions options;
    change(options);
    std::string error;
    EXPECT_FALSE(options.is_valid(&error));
    return error;
  };
  EXPECT_NE(message([](auto& o) { o.resolution = 7; }).find("field.resolution is 7"), std::string::npos);
  EXPECT_NE(message([](auto& o) { o.band = -1.0; }).find("field.band"), std::string::npos);
  EXPECT_NE(message([](auto& o) { o.list_cap = 0; }).find("field.list_cap is 0"), std::string::npos);
  EXPECT_NE(message([](auto& o) { o.brute_force_below = -1; }).find("brute_force_below"), std::string::npos);
  EXPECT_NE(message([](auto& o) { o.readback = "all"; }).find("\"all\""), std::string::npos);
  EXPECT_NE(message([](auto& o) { o.context = "glx"; }).find("\"egl\""), std::string::npos);
  EXPECT_NE(message([](auto& o) { o.primitives = "cones"; }).find("\"exact\""), std::string::npos);
}

}  // namespace
}  // namespace brink::gl_context_test
