#include "brink/core/shapes/sample_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>

#include "brink/core/base/error.h"
#include "brink/core/shapes/hull.h"
#include "brink/core/shapes/sampling.h"

namespace brink {

namespace {

/// Numbers larger than this have no meaning as lengths, speeds or masses.
constexpr double kLargest = 1e15;

/// Some characters without a blank between them, and where they begin, counting from 1.
struct Word {
  std::string_view text;
  int line = 0, column = 0;
};

/// A line that has words; its number counts from 1, with blank lines and comments.
struct Line {
  std::vector<Word> words;
  int number = 0;
};

/// Commas count as blanks. A carriage return does too, so that files with either line end are read.
std::vector<Word> words_of(std::string_view line, int number) {
  std::vector<Word> words;
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == ',' || c == '\f'; };
  for (std::size_t at = 0; at < line.size();) {
    while (at < line.size() && blank(line[at])) ++at;
    const std::size_t from = at;
    while (at < line.size() && !blank(line[at])) ++at;
    if (at > from) words.push_back({line.substr(from, at - from), number, static_cast<int>(from) + 1});
  }
  return words;
}

/// Lines that say something.
std::vector<Line> lines_of(std::string_view text) {
  std::vector<Line> lines;
  int number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    // of a line without a comment all is kept
    line = line.substr(0, line.find("//"));
    std::vector<Word> words = words_of(line, ++number);
    if (!words.empty()) lines.push_back({std::move(words), number});
  }
  return lines;
}

/// Reads line by line. A fault is noted, and reading goes on where the rest can still be told apart.
class Reader {
 public:
  Reader(std::string_view text, std::vector<SampleFileFault>& faults)
      : lines_(lines_of(text)),
        last_(1 + static_cast<int>(std::count(text.begin(), text.end(), '\n'))),
        faults_(faults) {}

  /// The first line is the count, the second the body, all others are samples.
  SampledBody read() {
    SampledBody body;
    const std::vector<double> count = numbers(1, "the number of samples");
    // without a count the samples cannot be checked; its fault has been noted
    if (stopped_ || std::isnan(count[0])) return body;
    const double most = kMostParticles;
    if (!(count[0] >= 1.0 && count[0] <= most && count[0] == std::floor(count[0])))
      return fault(lines_[0].words[0], "the number of samples is no count",
                   "a whole number from 1 to " + std::to_string(kMostParticles)),
             body;
    const std::vector<double> v = numbers(7, "mass x y vx vy rotation omega");
    if (stopped_) return body;
    body = {v[0], {v[1], v[2]}, {v[3], v[4]}, v[5], v[6], {}};
    if (body.mass <= 0.0) fault(lines_[1].words[0], "the mass is not > 0", "a number > 0 in kg");
    samples(static_cast<std::size_t>(count[0]), body.samples);
    return body;
  }

 private:
  /// Notes a fault at a word, of which at most 60 characters are shown.
  void fault(const Word& word, const std::string& wrong, const std::string& allowed) {
    faults_.push_back(
        {word.line, word.column,
         wrong + "; given \"" + std::string(word.text.substr(0, 60)) + "\", allowed: " + allowed});
  }

  /// The word as a number; NaN, and a fault, if it is none.
  double number(const Word& word) {
    double value = 0.0;
    std::string_view digits = word.text;
    // from_chars() takes no plus sign; one before a minus is left for it to refuse
    if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
    const char* end = digits.data() + digits.size();
    const auto [stop, error] = std::from_chars(digits.data(), end, value);
    // inf and nan, which it does take, are not <= kLargest
    if (error == std::errc() && stop == end && std::abs(value) <= kLargest) return value;
    fault(word, "not a number", "a finite number of at most 1e15");
    // no check of its size complains of the same word again
    return std::numeric_limits<double>::quiet_NaN();
  }

  /// The numbers of the next line, which must be `wanted` many.
  std::vector<double> numbers(std::size_t wanted, const std::string& what) {
    std::vector<double> values(wanted, 0.0);
    const std::string allowed = std::to_string(wanted) + (wanted == 1 ? " number: " : " numbers: ") + what;
    if (next_ == lines_.size()) {
      // no word is there to point at: the place is the end of the text
      faults_.push_back({last_, 1, "the file ends too soon; given nothing, allowed: " + allowed});
      stopped_ = true;
      return values;
    }
    const Line& line = lines_[next_++];
    if (line.words.size() != wanted) {
      // the first word too many, or the last one where there are too few
      fault(line.words[std::min(wanted, line.words.size() - 1)],
            "the line has " + std::to_string(line.words.size()) + " words", allowed);
      stopped_ = next_ <= 2;  // nothing after a wrong head can be trusted
      return values;
    }
    for (std::size_t k = 0; k < wanted; ++k) values[k] = number(line.words[k]);
    return values;
  }

  /// As many points as the first line promises. Exact repeats are faults: no two samples share a place.
  void samples(std::size_t count, std::vector<Vec2>& out) {
    std::map<std::pair<double, double>, int> taken;
    for (std::size_t k = 0; k < count && !stopped_; ++k) {
      const std::size_t before = faults_.size();
      if (next_ == lines_.size())
        return faults_.push_back({last_, 1,
                                  "the file ends too soon; given " + std::to_string(k) +
                                      " samples, allowed: the " + std::to_string(count) +
                                      " that its first line promises"});
      const std::vector<double> v = numbers(2, "x y of a sample");
      // the lines after a wrong one are read all the same, for their own faults
      if (faults_.size() != before) continue;
      const Line& line = lines_[next_ - 1];
      const auto [place, is_new] = taken.try_emplace({v[0], v[1]}, line.number);
      if (!is_new)
        fault(line.words[0], "the sample is that of line " + std::to_string(place->second),
              "each place once");
      out.emplace_back(v[0], v[1]);
    }
    // one fault for all lines too many
    if (next_ < lines_.size())
      fault(lines_[next_].words[0], "more than the " + std::to_string(count) + " samples of the first line",
            "comments after the last sample");
  }

  std::vector<Line> lines_;
  int last_;
  std::vector<SampleFileFault>& faults_;
  std::size_t next_ = 0;
  /// The file has ended, or its head is wrong: what follows would be misread.
  bool stopped_ = false;
};

/// The point that is farthest from p.
const Vec2& farthest(const std::vector<Vec2>& points, const Vec2& p) {
  return *std::max_element(points.begin(), points.end(), [&](const Vec2& a, const Vec2& b) {
    return (a - p).squaredNorm() < (b - p).squaredNorm();
  });
}

/// The ends of the line that all the points are on, up to the roundings of their coordinates; nothing if they
/// are on none. @pre the points are a convex hull's.
/// From the point farthest from any to the one farthest from that: on a line these are its two ends.
std::vector<Vec2> line_through(const std::vector<Vec2>& hull) {
  if (hull.size() == 2) return hull;
  const Vec2 from = farthest(hull, hull[0]), to = farthest(hull, from);
  double largest = 0.0, off = 0.0;
  for (const Vec2& p : hull) {
    largest = std::max(largest, p.norm());
    off = std::max(off, std::abs(cross(to - from, p - from)) / (to - from).norm());
  }
  // each coordinate is rounded to half of 2.2e-16 of itself, those of the ends too
  if (off > 8e-16 * largest) return {};
  return {from, to};
}

}  // namespace

SampledBody read_sample_file(std::string_view text, std::vector<SampleFileFault>& faults) {
  return Reader(text, faults).read();
}

Shape shape_of_samples(const std::vector<Vec2>& samples) {
  if (samples.empty()) throw BadInput("samples: none given; allowed: one or more");
  if (samples.size() == 1) return make_point(samples[0]);
  const std::vector<Vec2> hull = convex_hull(samples);
  if (const std::vector<Vec2> ends = line_through(hull); !ends.empty()) return make_chain(ends);
  try {
    return make_polygon(samples);
  } catch (const BadInput&) {  // not simple in this order
    return make_polygon(hull);
  }
}

}  // namespace brink
