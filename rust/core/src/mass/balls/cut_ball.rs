//! A unit ball cut by planes: volume, first and second moments about its center.
//!
//! By the divergence theorem they are integrals over the boundary, which consists of a patch of the sphere and of plane faces.
//! With h the height of a face over the center, u its normal, `x = h u + y` on it, and n a point of the unit sphere:
//!
//! `V = ∫dΩ/3 + Σ h ∫dA/3`, `∫ x dV = ∫ n dΩ/4 + Σ h ∫ x dA/4`, `∫ x xᵀ dV = ∫ n nᵀ dΩ/5 + Σ h ∫ x xᵀ dA/5`.
//!
//! The boundary of the patch are arcs of the circles in which the planes cut the sphere. Along them, by Stokes' theorem, patch to the
//! left and ν its outward normal in the sphere,
//!
//! `∫ n dΩ = ½ ∮ n × dn`, `∫ (n nᵀ − 1/3) dΩ = −⅙ ∮ (ν nᵀ + n νᵀ) ds`,
//!
//! and `∫ dΩ` is known up to whole spheres from the arcs and one point p: each arc adds the triangle from p to its chord and the segment
//! between chord and arc. A face is a convex polygon cut by a disk; its moments are sums over the triangles from the middle of the disk to its edges, and
//! over sectors.
//!
//! The polygons are those of a polyhedron, from which each plane cuts a piece. An edge belongs to two faces, and where it leaves the
//! ball is computed once; so the arcs form closed curves for any rounding, and what rounding moves changes the sums by no more than rounding.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Matrix3, Vector3};

use crate::mass::error_bound::UNIT;

/// Volume, first and second moments about the center of a ball.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moments {
    pub(super) volume: f64,
    pub(super) first: Vector3<f64>,
    pub(super) second: Matrix3<f64>,
    /// What rounding can have done to the volume.
    pub(super) error: f64,
    pub(super) radius: f64,
}

impl Moments {
    /// The same of a ball of this radius.
    pub(super) fn of_radius(&self, radius: f64) -> Self {
        let cube = radius * radius * radius;
        Self {
            volume: self.volume * cube,
            first: self.first * (cube * radius),
            second: self.second * (cube * radius * radius),
            error: self.error * cube,
            radius,
        }
    }

    /// Of the whole unit ball.
    fn of_ball() -> Self {
        Self {
            volume: 4.0 * PI / 3.0,
            first: Vector3::zeros(),
            second: Matrix3::identity() * (4.0 * PI / 15.0),
            error: 4.0 * UNIT,
            radius: 1.0,
        }
    }
}

/// A plane: what remains is `normal·x ≤ height`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    pub(super) normal: Vector3<f64>,
    pub(super) height: f64,
}

/// Half the edge of the cube from which the planes cut. Its faces do not meet the unit ball.
const HALF_EDGE: f64 = 1.5;

/// A plane that leaves no corner farther than this outside cuts nothing: it passes along a face, an edge or a corner.
const ALONG: f64 = 8.0 * UNIT;

/// Cuts a ball by planes; its memory serves for the next ball.
#[derive(Default)]
pub(super) struct Cutter {
    cell: Polyhedron,
    next: Polyhedron,
    heights: Vec<f64>,
    /// Where a corner of the old polyhedron is in the new one.
    places: Vec<usize>,
    /// New corners: the edge, by its inner and outer end, and the number of the corner.
    cuts: Vec<(usize, usize, usize)>,
    /// Edges of the new face.
    cap: Vec<(usize, usize)>,
    is_inside: Vec<bool>,
    arcs: Vec<Arc>,
    /// Of the arcs, cut into pieces.
    points: Vec<Vector3<f64>>,
}

/// A convex polyhedron, its faces counter-clockwise seen from outside.
#[derive(Default)]
struct Polyhedron {
    corners: Vec<Vector3<f64>>,
    /// The number of the plane of each face, and where its corners begin.
    faces: Vec<(usize, usize)>,
    loops: Vec<usize>,
}

impl Polyhedron {
    fn clear(&mut self) {
        self.corners.clear();
        self.faces.clear();
        self.loops.clear();
    }

    /// A cube about the origin, no face of which is in a plane that has a number.
    fn make_cube(&mut self) {
        const FACES: [[usize; 4]; 6] = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        self.clear();
        for corner in 0..8 {
            let side = |bit: usize| {
                if corner >> bit & 1 == 1 {
                    HALF_EDGE
                } else {
                    -HALF_EDGE
                }
            };
            self.corners.push(Vector3::new(side(0), side(1), side(2)));
        }
        for face in FACES {
            self.faces.push((usize::MAX, self.loops.len()));
            self.loops.extend(face);
        }
    }

    /// The number of the plane of a face, and its corners in order.
    fn face(&self, index: usize) -> (usize, &[usize]) {
        let (plane, from) = self.faces[index];
        let to = self
            .faces
            .get(index + 1)
            .map_or(self.loops.len(), |face| face.1);
        (plane, &self.loops[from..to])
    }
}

impl Cutter {
    /// The moments of the unit ball cut by these planes.
    pub(super) fn moments(&mut self, planes: &[Plane]) -> Moments {
        if planes.is_empty() {
            return Moments::of_ball();
        }
        self.cell.make_cube();
        for (number, plane) in planes.iter().enumerate() {
            self.cut(number, plane);
            if self.cell.faces.is_empty() {
                return Moments::default();
            }
        }
        self.measure(planes)
    }

    /// Cuts the polyhedron by a plane.
    fn cut(&mut self, number: usize, plane: &Plane) {
        let old = &self.cell;
        self.heights.clear();
        let height = |corner: &Vector3<f64>| plane.normal.dot(corner) - plane.height;
        self.heights.extend(old.corners.iter().map(height));
        if self.heights.iter().all(|&height| height <= ALONG) {
            return;
        }
        let new = &mut self.next;
        new.clear();
        self.places.clear();
        for (corner, &height) in old.corners.iter().zip(&self.heights) {
            self.places.push(new.corners.len());
            if height <= ALONG {
                new.corners.push(*corner);
            }
        }
        let is_in = |corner: usize| self.heights[corner] <= ALONG;
        self.cuts.clear();
        self.cap.clear();
        for face in 0..old.faces.len() {
            let (of_plane, corners) = old.face(face);
            let from = new.loops.len();
            // Where the face leaves the half-space and where it comes back, an edge of the cap runs the other way.
            let (mut left, mut came_first) = (None, None);
            for (k, &a) in corners.iter().enumerate() {
                let b = corners[(k + 1) % corners.len()];
                if is_in(a) {
                    new.loops.push(self.places[a]);
                }
                if is_in(a) == is_in(b) {
                    continue;
                }
                let (inner, outer) = if is_in(a) { (a, b) } else { (b, a) };
                let known = (self.cuts.iter()).find(|cut| (cut.0, cut.1) == (inner, outer));
                let corner = known.map_or(new.corners.len(), |cut| cut.2);
                if known.is_none() {
                    let (p, q) = (self.heights[inner], self.heights[outer]);
                    let part = (p / (p - q)).clamp(0.0, 1.0);
                    let start = old.corners[inner];
                    new.corners
                        .push(start + (old.corners[outer] - start) * part);
                    self.cuts.push((inner, outer, corner));
                }
                new.loops.push(corner);
                if is_in(a) {
                    left = Some(corner);
                } else if let Some(leaving) = left.take() {
                    self.cap.push((corner, leaving));
                } else {
                    came_first = Some(corner);
                }
            }
            if let (Some(leaving), Some(coming)) = (left, came_first) {
                self.cap.push((coming, leaving));
            }
            if new.loops.len() > from {
                new.faces.push((of_plane, from));
            }
        }
        // The edges of the cap form one loop; more where rounding has cut a corner from the polygon.
        while let Some((start, mut end)) = self.cap.pop() {
            new.faces.push((number, new.loops.len()));
            new.loops.push(start);
            while let Some(k) = self.cap.iter().position(|edge| edge.0 == end) {
                new.loops.push(end);
                end = self.cap.swap_remove(k).1;
            }
        }
        std::mem::swap(&mut self.cell, &mut self.next);
    }

    /// The moments of the unit ball within the polyhedron.
    fn measure(&mut self, planes: &[Plane]) -> Moments {
        let cell = &self.cell;
        self.is_inside.clear();
        (self.is_inside).extend(cell.corners.iter().map(|r| r.norm_squared() <= 1.0));
        self.arcs.clear();
        let mut sum = Boundary::default();
        let (mut largest, mut caps) = (0.0_f64, 0.0);
        for face in 0..cell.faces.len() {
            let (number, corners) = cell.face(face);
            let Some(plane) = planes.get(number).filter(|plane| plane.height.abs() < 1.0) else {
                continue; // of the cube
            };
            let cap = TAU * (1.0 - plane.height);
            largest = largest.max(cap);
            caps += cap;
            let arcs = self.arcs.len();
            let mut disk = Disk::new(plane, &mut self.arcs);
            disk.go_round(&cell.corners, &self.is_inside, corners);
            disk.finish(&mut sum);
            for arc in &self.arcs[arcs..] {
                sum.add_arc(arc);
            }
        }
        let removed = removed_area(&self.arcs, &mut self.points);
        let whole = 2.0 * TAU;
        let mut area = (-removed).rem_euclid(whole);
        // The patch is smaller than the sphere without its largest cap, and larger than the sphere without all of them.
        if area > whole - 0.5 * largest {
            area -= whole;
        } else if area < 0.5 * (whole - caps) {
            area += whole;
        }
        sum.moments(area, cell.faces.len())
    }
}

/// An arc of the circle in which a plane cuts the unit sphere, counter-clockwise about its normal.
struct Arc {
    plane: Plane,
    from: Vector3<f64>,
    to: Vector3<f64>,
    angle: f64,
    is_circle: bool,
}

/// What the integrals over the boundary come to.
#[derive(Default)]
struct Boundary {
    volume: f64,
    first: Vector3<f64>,
    second: Matrix3<f64>,
    /// `∫ n dΩ` and `∫ (n nᵀ − 1/3) dΩ`.
    normal: Vector3<f64>,
    square: Matrix3<f64>,
}

impl Boundary {
    /// What the arc adds to the integrals over the patch, which is on its right.
    fn add_arc(&mut self, arc: &Arc) {
        let (u, h, angle) = (arc.plane.normal, arc.plane.height, arc.angle);
        let square = (1.0 - h) * (1.0 + h);
        let chord = (arc.to - arc.from).cross(&u);
        self.normal -= (u * (square * angle) - chord * h) * 0.5;
        let n = u * (h * angle) + chord;
        let in_plane = Matrix3::identity() - u * u.transpose();
        let nn = u * u.transpose() * (h * h * angle)
            + twice_symmetric(&u, &chord) * h
            + in_plane * (0.5 * square * angle)
            - (twist(&arc.to, &arc.plane) - twist(&arc.from, &arc.plane)) * 0.25;
        self.square -= (twice_symmetric(&u, &n) - nn * (2.0 * h)) / 6.0;
    }

    /// The moments, with this area of the patch.
    fn moments(&self, area: f64, faces: usize) -> Moments {
        let sphere = self.square + Matrix3::identity() * (area / 3.0);
        let second = (self.second + sphere) * 0.2;
        Moments {
            volume: self.volume + area / 3.0,
            first: self.first + self.normal * 0.25,
            second: (second + second.transpose()) * 0.5,
            error: (16 + 16 * faces) as f64 * UNIT,
            radius: 1.0,
        }
    }
}

/// `a bᵀ + b aᵀ`.
fn twice_symmetric(a: &Vector3<f64>, b: &Vector3<f64>) -> Matrix3<f64> {
    a * b.transpose() + b * a.transpose()
}

/// `s tᵀ + t sᵀ`, s from the middle of the circle to a point of it and t along it: its derivative by the angle is `2 (t tᵀ − s sᵀ)`.
fn twist(point: &Vector3<f64>, plane: &Plane) -> Matrix3<f64> {
    let u = plane.normal;
    twice_symmetric(&(point - u * plane.height), &u.cross(point))
}

/// A face: a polygon cut by the disk in which its plane cuts the unit ball.
struct Disk<'a> {
    plane: Plane,
    arcs: &'a mut Vec<Arc>,
    first_arc: usize,
    /// `∫ dA`, `∫ y dA`, `∫ y yᵀ dA`, y from the middle of the disk.
    area: f64,
    first: Vector3<f64>,
    second: Matrix3<f64>,
}

impl<'a> Disk<'a> {
    fn new(plane: &Plane, arcs: &'a mut Vec<Arc>) -> Self {
        Self {
            plane: *plane,
            first_arc: arcs.len(),
            arcs,
            area: 0.0,
            first: Vector3::zeros(),
            second: Matrix3::zeros(),
        }
    }

    /// The polygon with these corners: triangles where its edges are in the disk, arcs where they are outside.
    fn go_round(&mut self, points: &[Vector3<f64>], is_inside: &[bool], corners: &[usize]) {
        // The way outside: from where it left the disk, and how far it has turned since; at first, before it came in.
        let mut left = None;
        let mut turn = 0.0;
        let mut came_first = None;
        for (k, &a) in corners.iter().enumerate() {
            let b = corners[(k + 1) % corners.len()];
            let (p, q) = (points[a], points[b]);
            let Some((enter, leave)) = crossings(points, is_inside, a, b) else {
                turn += self.quarters(&p, &q);
                continue;
            };
            if let Some(enter) = enter {
                turn += self.quarters(&p, &enter);
                match left.take() {
                    Some(from) => self.push_arc(from, enter, turn),
                    None => came_first = Some((enter, turn)),
                }
                turn = 0.0;
            }
            self.add_triangle(&enter.unwrap_or(p), &leave.unwrap_or(q));
            if let Some(leave) = leave {
                left = Some(leave);
                turn = self.quarters(&leave, &q);
            }
        }
        match (left, came_first) {
            (Some(from), Some((to, before))) => self.push_arc(from, to, turn + before),
            // All edges are outside the disk, and it is within the polygon or not.
            (None, None) if turn > 2.0 => {
                self.arcs.push(Arc {
                    plane: self.plane,
                    from: self.plane.normal,
                    to: self.plane.normal,
                    angle: TAU,
                    is_circle: true,
                });
            }
            _ => {}
        }
    }

    /// Adds the arc between two points, on the way between which the polygon turned by about so many quarters.
    fn push_arc(&mut self, from: Vector3<f64>, to: Vector3<f64>, turn: f64) {
        let plane = self.plane;
        let (p, q) = (self.place(&from), self.place(&to));
        let angle = plane.normal.dot(&p.cross(&q)).atan2(p.dot(&q));
        let rounds = ((turn * FRAC_PI_2 - angle) / TAU).round();
        self.arcs.push(Arc {
            plane,
            from,
            to,
            angle: angle + rounds * TAU,
            is_circle: false,
        });
    }

    /// From the middle of the disk.
    fn place(&self, point: &Vector3<f64>) -> Vector3<f64> {
        point - self.plane.normal * self.plane.height
    }

    /// The angle from one point to another, seen from the middle of the disk, in quarters of a turn and off by at most a
    /// tenth of a quarter: enough to count rounds.
    fn quarters(&self, from: &Vector3<f64>, to: &Vector3<f64>) -> f64 {
        let (p, q) = (self.place(from), self.place(to));
        let (y, x) = (self.plane.normal.dot(&p.cross(&q)), p.dot(&q));
        let sum = x.abs() + y.abs();
        if sum == 0.0 {
            return 0.0;
        }
        (1.0 - x / sum).copysign(y)
    }

    fn add_triangle(&mut self, from: &Vector3<f64>, to: &Vector3<f64>) {
        let (p, q) = (self.place(from), self.place(to));
        let area = 0.5 * self.plane.normal.dot(&p.cross(&q));
        let sum = p + q;
        self.area += area;
        self.first += sum * (area / 3.0);
        self.second +=
            (p * p.transpose() + q * q.transpose() + sum * sum.transpose()) * (area / 12.0);
    }

    /// Adds the sectors under the arcs, and the cone from the center of the ball over the face.
    fn finish(mut self, sum: &mut Boundary) {
        let (u, h) = (self.plane.normal, self.plane.height);
        let square = (1.0 - h) * (1.0 + h);
        let in_plane = Matrix3::identity() - u * u.transpose();
        for arc in &self.arcs[self.first_arc..] {
            self.area += 0.5 * square * arc.angle;
            self.first += (arc.to - arc.from).cross(&u) * (square / 3.0);
            let turned = twist(&arc.to, &self.plane) - twist(&arc.from, &self.plane);
            self.second +=
                in_plane * (square * square * arc.angle / 8.0) - turned * (square / 16.0);
        }
        let first = u * (h * self.area) + self.first;
        let second = u * u.transpose() * (h * h * self.area)
            + twice_symmetric(&u, &self.first) * h
            + self.second;
        sum.volume += h * self.area / 3.0;
        sum.first += first * (h * 0.25);
        sum.second += second * h;
    }
}

/// Where an edge enters a ball and leaves it.
type Ends = (Option<Vector3<f64>>, Option<Vector3<f64>>);

/// Where the edge from corner a to corner b is in the unit ball: where it enters and leaves, `None` where it does at its ends. `None`
/// of an edge outside.
///
/// Both faces of an edge ask: so what decides is computed in one order of its ends.
fn crossings(points: &[Vector3<f64>], is_inside: &[bool], a: usize, b: usize) -> Option<Ends> {
    if is_inside[a] && is_inside[b] {
        return Some((None, None));
    }
    let (low, high) = (a.min(b), a.max(b));
    let (p, edge) = (points[low], points[high] - points[low]);
    let length = edge.norm_squared();
    if length == 0.0 {
        return None;
    }
    let middle = -p.dot(&edge) / length;
    let square = 1.0 - (p + edge * middle).norm_squared();
    if square <= 0.0 && !(is_inside[a] || is_inside[b]) {
        return None;
    }
    let half = (square.max(0.0) / length).sqrt();
    let from = if is_inside[low] {
        0.0
    } else {
        (middle - half).clamp(0.0, 1.0)
    };
    let to = if is_inside[high] {
        1.0
    } else {
        (middle + half).clamp(0.0, 1.0)
    };
    if from >= to && !(is_inside[a] || is_inside[b]) {
        return None;
    }
    let at = |part: f64, is_end: bool| (!is_end).then(|| p + edge * part);
    let (first, last) = (at(from, is_inside[low]), at(to, is_inside[high]));
    Some(if a == low {
        (first, last)
    } else {
        (last, first)
    })
}

/// The area that the arcs enclose on their left, up to whole spheres; `points` is memory for their pieces.
fn removed_area(arcs: &[Arc], points: &mut Vec<Vector3<f64>>) -> f64 {
    points.clear();
    for arc in arcs.iter().filter(|arc| !arc.is_circle) {
        arc.push_points(points);
    }
    let pole = pole(points);
    let mut sum = 0.0;
    let mut first = 0;
    for arc in arcs {
        // About the normal that points to the nearer cap.
        let near = arc.plane.height.abs();
        let angle = arc.angle.copysign(arc.angle * arc.plane.height);
        let (less, more) = (1.0 - near, 1.0 + near);
        if arc.is_circle {
            sum += angle * less;
            continue;
        }
        let pieces = arc.pieces();
        let step = angle / pieces as f64;
        let (sine, cosine) = step.sin_cos();
        let segment = step * less - 2.0 * (less * sine).atan2(more + less * cosine);
        sum += segment * pieces as f64;
        for k in first..first + pieces {
            let (from, to) = (points[k], points[k + 1]);
            let volume = pole.dot(&from.cross(&to));
            let around = 1.0 + pole.dot(&from) + from.dot(&to) + to.dot(&pole);
            sum += 2.0 * volume.atan2(around);
        }
        first += pieces + 1;
    }
    sum
}

impl Arc {
    /// In how many pieces its area is taken, each of a quarter of a circle at most.
    fn pieces(&self) -> usize {
        let quarters = self.angle.abs() / FRAC_PI_2;
        1 + usize::from(quarters > 1.0) + usize::from(quarters > 2.0) + usize::from(quarters > 3.0)
    }

    /// Adds its ends and the points that cut it into pieces.
    fn push_points(&self, points: &mut Vec<Vector3<f64>>) {
        let middle = self.plane.normal * self.plane.height;
        let (s, t) = (self.from - middle, self.plane.normal.cross(&self.from));
        let pieces = self.pieces();
        points.push(self.from);
        for k in 1..pieces {
            let (sine, cosine) = (self.angle * (k as f64 / pieces as f64)).sin_cos();
            points.push(middle + s * cosine + t * sine);
        }
        points.push(self.to);
    }
}

/// A point of the sphere whose opposite is far from these points: a triangle that reaches to the opposite of a corner is known
/// badly.
fn pole(points: &[Vector3<f64>]) -> Vector3<f64> {
    /// Farther than this, no digit that counts is lost.
    const FAR: f64 = 0.2;
    let directions = (0..27).filter(|&k| k != 13).map(|k| {
        let digit = |of: i32| f64::from(of % 3 - 1);
        // Askew, since points lie along axes and diagonals more often than elsewhere.
        Vector3::new(digit(k) + 0.21, digit(k / 3) - 0.13, digit(k / 9) + 0.07).normalize()
    });
    let mut best = (f64::NEG_INFINITY, Vector3::z());
    for pole in directions {
        let mut nearest = f64::INFINITY;
        for point in points {
            nearest = nearest.min(1.0 + pole.dot(point));
            if nearest <= best.0 {
                break;
            }
        }
        if nearest > best.0 {
            best = (nearest, pole);
        }
        if nearest > FAR {
            break;
        }
    }
    best.1
}
