// The work space leases fields under a name, for a scope.
#include "field/work_space.hpp"

#include <gtest/gtest.h>

using namespace eulastic;

namespace {

struct WorkSpaceTest : testing::Test {
  Domain domain;
  void SetUp() override {
    GridSpec spec;
    spec.cells = {8, 8, 1};
    ASSERT_EQ(domain.create(PETSC_COMM_SELF, spec), 0);
  }
  // Returns the error code of a lease, without PETSc's message.
  static PetscErrorCode quietly(WorkSpace &work, int count, WorkSpace::Lease *lease) {
    PetscPushErrorHandler(PetscReturnErrorHandler, nullptr);
    const PetscErrorCode error = work.lease("more", count, lease);
    PetscPopErrorHandler();
    return error;
  }
};

TEST_F(WorkSpaceTest, FieldsAreFreeAgainAfterTheScope) {
  WorkSpace work(domain);
  ASSERT_EQ(work.reserve(3), 0);
  const double *first;
  {
    WorkSpace::Lease one, two, more;
    ASSERT_EQ(work.lease("one", 1, &one), 0);
    ASSERT_EQ(work.lease("two", 2, &two), 0);
    first = one.fields().data();
    EXPECT_EQ(two.fields().data(), first + domain.layout().size);
    EXPECT_EQ(two.part(1, 1).data(), first + 2 * domain.layout().size);
    EXPECT_NE(quietly(work, 1, &more), 0);
  }
  WorkSpace::Lease all;
  ASSERT_EQ(work.lease("all", 3, &all), 0);
  EXPECT_EQ(all.fields().data(), first);
}

TEST_F(WorkSpaceTest, DoesNotGrowUnderALease) {
  WorkSpace work(domain);
  ASSERT_EQ(work.reserve(1), 0);
  WorkSpace::Lease lease;
  ASSERT_EQ(work.lease("one", 1, &lease), 0);
  PetscPushErrorHandler(PetscReturnErrorHandler, nullptr);
  EXPECT_NE(work.reserve(2), 0);
  PetscPopErrorHandler();
  EXPECT_EQ(work.reserve(1), 0);
}

}  // namespace
