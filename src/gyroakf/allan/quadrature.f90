! SPDX-License-Identifier: MIT
!> Nodes and weights of the Gauss and Legendre quadrature with six points on 0 .. 1.
module gyroakf_allan_quadrature
   use gyroakf_kinds, only : dp
   implicit none (type, external)
   private
   public :: node_count, node, weight

   !> Number of nodes
   integer, parameter :: node_count = 6
   !> Their places, and weights of sum 1
   real(dp), parameter :: node(node_count) = [0.033765242898423986_dp, 0.16939530676686776_dp, 0.38069040695840156_dp, &
      & 0.61930959304159844_dp, 0.83060469323313224_dp, 0.96623475710157601_dp]
   real(dp), parameter :: weight(node_count) = [0.085662246189585178_dp, 0.18038078652406930_dp, 0.23395696728634552_dp, &
      & 0.23395696728634552_dp, 0.18038078652406930_dp, 0.085662246189585178_dp]

end module gyroakf_allan_quadrature
