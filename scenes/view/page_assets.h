#pragma once
/// The parts of the replay page, as they are in scenes/view/page; embedded when Brink is built.

#include <string_view>

namespace brink::page {

std::string_view html();
std::string_view style();
std::string_view script();
/// The library that draws charts (Debian's libjs-dygraphs) with its style; empty where Brink was built without it.
std::string_view chart_script();
std::string_view chart_style();

}  // namespace brink::page
