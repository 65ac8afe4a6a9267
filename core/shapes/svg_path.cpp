/// A parser by hand for the grammar of SVG 2, section 9.3. Scanner reads characters, Parser commands:
///
///     until the end: a command's letter, then its arguments once or more
///     Z takes none; M's further pairs are lines
///
/// Every piece is stored with absolute points, and starts where the pen is. A subpath ends at Z, at the next M,
/// or with the data. Faults name the character, counted from 1.
#include "brink/core/shapes/svg_path.h"

#include <cctype>
#include <charconv>

#include "brink/core/base/error.h"

namespace brink {

namespace {

/// Reads numbers, flags and commands, and knows where it is.
class Scanner {
 public:
  explicit Scanner(std::string_view d) : d_(d) {}

  void skip_space() {
    while (at_ < d_.size() && is_space(d_[at_])) ++at_;
  }
  bool done() const { return at_ == d_.size(); }
  /// The end reads as a zero character, which no test below accepts.
  char peek() const { return done() ? '\0' : d_[at_]; }
  /// Any letter, also one that is no command. An exponent's e is never looked at: number() takes it.
  bool at_command() const { return !done() && std::isalpha(static_cast<unsigned char>(peek())); }
  char take() { return d_[at_++]; }

  /// Between two numbers: spaces and at most one comma. True if a comma was there.
  bool skip_separator() {
    skip_space();
    if (peek() != ',') return false;
    ++at_;
    skip_space();
    return true;
  }

  /// The number that starts here, as long as the grammar lets it be: "1.5.5" is two of them.
  double number() {
    const std::size_t start = at_;
    std::size_t digits = at_;
    if (peek() == '+' || peek() == '-') ++digits;
    // from_chars() would take "inf" and "nan" too
    const bool has_digit =
        digits < d_.size() && (is_digit(digits) || (d_[digits] == '.' && is_digit(digits + 1)));
    if (!has_digit) fail("expected a number");
    // from_chars() takes no plus sign
    const char* first = d_.data() + (peek() == '+' ? at_ + 1 : at_);
    double value = 0.0;
    const auto [end, error] = std::from_chars(first, d_.data() + d_.size(), value);
    if (error != std::errc()) fail("this number is out of range");
    at_ = static_cast<std::size_t>(end - d_.data());
    // so that squares of lengths stay finite
    if (!(std::abs(value) <= 1e150)) fail_at(start, "this number is out of range");
    return value;
  }

  /// One character: flags may follow each other, and numbers them, without a separator.
  bool flag() {
    if (peek() != '0' && peek() != '1') fail("expected a flag, 0 or 1");
    return take() == '1';
  }

  [[noreturn]] void fail(const std::string& what) const { fail_at(at_, what); }
  /// What was expected there, and what stands there.
  [[noreturn]] void fail_at(std::size_t at, const std::string& what) const {
    const std::string got = at < d_.size() ? std::string{'\'', d_[at], '\''} : "the end of the data";
    throw BadInput("path: character " + std::to_string(at + 1) + ": " + what + ", got " + got);
  }

 private:
  /// White space of the grammar: without the vertical tab, which std::isspace() has too.
  static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f'; }
  bool is_digit(std::size_t k) const { return k < d_.size() && d_[k] >= '0' && d_[k] <= '9'; }

  std::string_view d_;
  std::size_t at_ = 0;
};

/// The pen, the subpath that is open, and what there is of the path so far.
class Parser {
 public:
  explicit Parser(std::string_view d) : scan_(d) {}

  std::vector<Subpath> parse() {
    scan_.skip_space();
    if (scan_.done()) scan_.fail("expected path data that starts with M or m");
    if (scan_.peek() != 'M' && scan_.peek() != 'm') scan_.fail("path data must start with M or m");
    while (!scan_.done()) {
      if (!scan_.at_command()) scan_.fail("expected a command (one of MLHVCSQTAZ)");
      run_command();
      scan_.skip_space();
    }
    end_subpath();
    return std::move(subpaths_);
  }

 private:
  /// A letter with all its argument sets.
  void run_command();
  /// One argument set; `command` is a capital.
  void run_once(char command);
  void move_to(const Vec2& p);
  void close();
  void end_subpath();

  void line_to(const Vec2& p);
  void cubic_to(const Vec2& c1, const Vec2& c2, const Vec2& p);
  void quadratic_to(const Vec2& c, const Vec2& p);
  void arc_to();

  /// Arguments: a separator, then what is wanted. Points, and single coordinates, are absolute afterwards.
  double next_number() {
    separate();
    return scan_.number();
  }
  bool next_flag() {
    separate();
    return scan_.flag();
  }
  /// A separator, except before the first argument of a command, where only space may stand.
  void separate() {
    if (first_argument_)
      scan_.skip_space();
    else
      scan_.skip_separator();
    first_argument_ = false;
  }
  Vec2 next_point() {
    const double x = next_number();
    const double y = next_number();
    return relative_ ? Vec2(current_ + Vec2(x, y)) : Vec2(x, y);
  }
  double next_x() { return next_number() + (relative_ ? current_.x() : 0.0); }
  double next_y() { return next_number() + (relative_ ? current_.y() : 0.0); }

  Scanner scan_;
  std::vector<Subpath> subpaths_;
  Subpath open_;
  // where the pen is, and where the subpath began: what follows Z without M starts there again
  Vec2 current_ = Vec2::Zero(), start_ = Vec2::Zero();
  // Every other command puts them where the pen is, so that nothing is mirrored after it.
  Vec2 last_cubic_ = Vec2::Zero(), last_quadratic_ = Vec2::Zero();  ///< control points that S and T mirror
  bool relative_ = false;
  /// What comes next is the first argument of a command: no comma may stand before it.
  bool first_argument_ = false;
};

void Parser::run_command() {
  const std::size_t none = std::string_view::npos;
  const char letter = scan_.peek();
  char command = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
  // before it is taken, so that the fault names its place
  if (std::string_view("MLHVCSQTAZ").find(command) == none)
    scan_.fail("unknown command (allowed: MLHVCSQTAZ in either case)");
  scan_.take();
  relative_ = letter != command;
  // no arguments: what follows must be a command
  if (command == 'Z') return close();
  first_argument_ = true;
  for (;;) {
    run_once(command);
    if (command == 'M') command = 'L';  // further pairs after a move are lines
    // what is neither the end nor a letter is another set of arguments
    const bool comma = scan_.skip_separator();
    if (scan_.done() || scan_.at_command()) {
      if (comma) scan_.fail("expected a number after the comma");
      return;
    }
    // the separator before it has been taken
    first_argument_ = true;
  }
}

void Parser::run_once(char command) {
  switch (command) {
    case 'M':
      return move_to(next_point());
    case 'L':
      return line_to(next_point());
    case 'H':
      return line_to({next_x(), current_.y()});
    case 'V':
      return line_to({current_.x(), next_y()});
    case 'C': {
      // one declaration a point, in the order of the text: arguments of a call would be read in any order
      const Vec2 c1 = next_point(), c2 = next_point(), p = next_point();
      return cubic_to(c1, c2, p);
    }
    case 'S': {
      const Vec2 c2 = next_point(), p = next_point();
      // after anything but C and S the control point is the current point, and so is its mirror image
      return cubic_to(2 * current_ - last_cubic_, c2, p);
    }
    case 'Q': {
      const Vec2 c = next_point(), p = next_point();
      return quadratic_to(c, p);
    }
    case 'T':
      // in either order: reading a point does not move the pen
      return quadratic_to(2 * current_ - last_quadratic_, next_point());
    default:
      return arc_to();
  }
}

/// What was open ends here; the pen and both mirrored control points are put to p.
void Parser::move_to(const Vec2& p) {
  end_subpath();
  current_ = start_ = last_cubic_ = last_quadratic_ = p;
}

/// Keeps the subpath if it draws something.
void Parser::end_subpath() {
  if (!open_.pieces.empty()) {
    // a subpath that comes back to its start is closed without Z as well
    open_.closed = open_.closed || open_.pieces.back().to == open_.pieces.front().from;
    subpaths_.push_back(std::move(open_));
  }
  open_ = Subpath();
}

/// Z: a line to the start, unless the pen is there.
void Parser::close() {
  line_to(start_);
  open_.closed = true;
  end_subpath();
}

void Parser::line_to(const Vec2& p) {
  // no piece of length 0, which could not be a site; so Z after a closing line draws nothing
  if (p != current_) {
    PathPiece piece;
    piece.from = current_;
    piece.to = p;
    open_.pieces.push_back(piece);
  }
  current_ = last_cubic_ = last_quadratic_ = p;
}

/// Left out where all four points are one. Only the cubic's control point is kept: a T after it mirrors nothing.
void Parser::cubic_to(const Vec2& c1, const Vec2& c2, const Vec2& p) {
  PathPiece piece;
  piece.kind = PathPieceKind::cubic;
  piece.from = current_;
  piece.control_1 = c1;
  piece.control_2 = c2;
  piece.to = p;
  if (c1 != current_ || c2 != current_ || p != current_) open_.pieces.push_back(piece);
  current_ = last_quadratic_ = p;
  last_cubic_ = c2;
}

void Parser::quadratic_to(const Vec2& c, const Vec2& p) {
  // degree elevation: the cubic of the same points has its control points two thirds of the way to the quadratic's
  const Vec2 c1 = current_ + 2.0 / 3.0 * (c - current_), c2 = p + 2.0 / 3.0 * (c - p);
  cubic_to(c1, c2, p);
  // cubic_to() has set it to c2, but S after Q mirrors nothing
  last_cubic_ = p;
  last_quadratic_ = c;
}

/// Flags and radii are kept as written, radii without their sign; path_shape.cpp finds the centre.
void Parser::arc_to() {
  PathPiece piece;
  piece.kind = PathPieceKind::arc;
  piece.from = current_;
  piece.rx = std::abs(next_number());
  piece.ry = std::abs(next_number());
  piece.rotation = next_number();
  piece.large = next_flag();
  piece.sweep = next_flag();
  piece.to = next_point();
  if (piece.rx == 0.0 || piece.ry == 0.0) return line_to(piece.to);  // SVG 2, 9.5.1
  // to where it starts it is left out (SVG 2, 9.5.1)
  if (piece.to != current_) open_.pieces.push_back(piece);
  current_ = last_cubic_ = last_quadratic_ = piece.to;
}

}  // namespace

std::vector<Subpath> parse_svg_path(std::string_view d) { return Parser(d).parse(); }

}  // namespace brink
