// SPDX-License-Identifier: Apache-2.0
// Somebody's program has words of its own and says `using namespace reflectree`: its own are meant, without a
// word about whose. tests/guard compiles this with every public header, and once with a planted clash.
#include <cstdio>
#include <reflectree/brdf/material/mixture.hpp>
#include <reflectree/brdf/material/registry.hpp>
#include <reflectree/math/cubature.hpp>
#include <reflectree/math/frame.hpp>
#include <reflectree/math/sum.hpp>
#include <reflectree/sampler/any_sampler.hpp>
#include <reflectree/sampler/sampler.hpp>

#ifdef PLANTED_CLASH
namespace reflectree {
struct Cell {};
}  // namespace reflectree
#endif

using namespace reflectree;

// Types. Each is told from others of its name by its size.
#define OWN(name)   \
  struct name {     \
    char mine[977]; \
  };                \
  static_assert(sizeof(name) == 977)

OWN(Cell);
OWN(Tree);
OWN(Split);
OWN(Leaf);
OWN(Box);
OWN(Node);
OWN(Point);
OWN(Slab);
OWN(Coordinate);
OWN(Parameter);
OWN(Description);
OWN(Rectangle);
OWN(Region);
OWN(Sum);
OWN(Product);
OWN(Difference);
OWN(Frame);
OWN(Lobe);
OWN(Basis);
OWN(Edge);
OWN(Face);
OWN(Vertex);
OWN(Triangle);
OWN(Mesh);
OWN(Ray);
OWN(Hit);
OWN(Camera);
OWN(Scene);
OWN(Light);
OWN(Color);
OWN(Colour);
OWN(Texture);
OWN(Matrix);
OWN(Transform);
OWN(Vector);
OWN(Table);
OWN(Entry);
OWN(Item);
OWN(Value);
OWN(Range);
OWN(Interval);
OWN(Grid);
OWN(Bin);
OWN(Sample);
OWN(Random);
OWN(Rng);
OWN(Options);
OWN(Result);
OWN(Status);
OWN(Kind);
OWN(Field);
OWN(Header);
OWN(Chunk);
OWN(Buffer);
OWN(Record);
OWN(Context);
OWN(Timer);
OWN(Progress);
OWN(Stack);
OWN(Queue);
OWN(Graph);
OWN(Path);
OWN(File);
OWN(Reader);
OWN(Writer);
OWN(Parser);
OWN(Token);
OWN(Model);
OWN(Layer);

// Functions. The last three have the parameters of a library's own words: in silence another may be taken.
int lift(int x) { return x + 1; }
int lower(int x) { return x - 1; }
int pack(int x) { return 2 * x; }
int append(int x) { return 3 * x; }
int fill(int x) { return 4 * x; }
int find(int x) { return 5 * x; }
int area(int x) { return 6 * x; }
double trace(double x) { return x; }
double channel(double value, int) { return value + 100; }
double scaled(double value, double by) { return value + by; }
double lerp(double a, double b, double t) { return a + t * (b - a); }

int main() {
  const auto sampler = make_sampler([](Direction, Direction) { return 1 / pi; });
  const bool types = sizeof(Cell) + sizeof(Tree) + sizeof(Split) + sizeof(Leaf) + sizeof(Node) == 5 * 977;
  const bool functions = lift(1) + lower(1) + pack(1) + append(1) + fill(1) + find(1) + area(1) == 22;
  const float two = 2, four = 4, quarter = 0.25f;
  const bool silent = channel(two, 0) == 102 && scaled(two, four) == 6 && lerp(two, four, quarter) == 2.5;
  Pcg32 random(1);
  const bool drawn = sampler.one_shot.sample(Direction{0, 0, 1}, random).has_value();
  std::printf("types %d, functions %d, silent ones %d\n", types, functions, silent);
  return types && functions && silent && drawn && trace(0) == 0 ? 0 : 1;
}
