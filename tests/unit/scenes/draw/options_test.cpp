// What may be asked of a picture, and how a wrong wish is answered.
#include <gmock/gmock.h>

#include "brink/scenes/draw/draw.h"

namespace brink::options_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Throws;

template <class Call>
std::string message_of(Call&& call) {
  try {
    call();
  } catch (const BadInput& error) {
    return error.what();
  }
  return "(no BadInput)";
}

TEST(DrawLayer, KnownNamesAreParsed) {
  EXPECT_EQ(parse_layer("scene").kind, DrawLayer::Kind::scene);
  EXPECT_EQ(parse_layer("color").kind, DrawLayer::Kind::color);
  EXPECT_EQ(parse_layer("depth").kind, DrawLayer::Kind::depth);
  EXPECT_EQ(parse_layer("forces").kind, DrawLayer::Kind::forces);
}

TEST(DrawLayer, PassCarriesTheBodysNameWithItsBrackets) {
  const DrawLayer layer = parse_layer("pass:disc[3]");
  EXPECT_EQ(layer.kind, DrawLayer::Kind::pass);
  EXPECT_EQ(layer.body, "disc[3]");
}

TEST(DrawLayer, UnknownNamesAreToldWithThoseAllowed) {
  for (const char* wrong : {"", "Scene", "colour", "pass", "pass:", "depth "}) {
    const std::string message = message_of([&] { parse_layer(wrong); });
    EXPECT_THAT(message, HasSubstr("scene, color, depth, forces, pass:BODY"));
    EXPECT_THAT(message, HasSubstr("\"" + std::string(wrong) + "\""));
  }
}

TEST(PictureSize, WidthAndHeightAreParsed) {
  const PictureSize size = parse_size("640x48");
  EXPECT_EQ(size.width, 640);
  EXPECT_EQ(size.height, 48);
}

TEST(PictureSize, AnythingElseIsToldWithWhatIsAllowed) {
  for (const char* wrong : {"", "640", "640x", "x480", "640X480", "640x480 ", "640x480x2", "15x480",
                            "640x8193", "-640x480", "1e3x480", "99999999999x480"})
    EXPECT_THAT(message_of([&] { parse_size(wrong); }), HasSubstr("WIDTHxHEIGHT")) << wrong;
}

TEST(DrawOptions, DefaultsAreValid) {
  std::string error;
  EXPECT_TRUE(DrawOptions{}.is_valid(&error)) << error;
}

TEST(DrawOptions, WrongValuesAreNamed) {
  std::string error;
  DrawOptions margin;
  margin.margin = -0.1;
  EXPECT_FALSE(margin.is_valid(&error));
  EXPECT_THAT(error, HasSubstr("margin: -0.1"));
  DrawOptions arrows;
  arrows.arrow_seconds = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(arrows.is_valid(&error));
  EXPECT_THAT(error, HasSubstr("arrow_seconds"));
  DrawOptions view;
  view.view = Box{};  // empty: nothing to be seen
  EXPECT_FALSE(view.is_valid(&error));
  EXPECT_THAT(error, HasSubstr("view"));
  DrawOptions size;
  size.size.width = 0;
  EXPECT_FALSE(size.is_valid(nullptr));
}

}  // namespace
}  // namespace brink::options_test
