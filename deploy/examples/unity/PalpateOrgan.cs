// An organ in a Unity scene that can be felt and seen: a sketch. The tests compile and run it with Mono; it was NOT run in Unity.
//
// Add this component to an object with a MeshFilter and a MeshRenderer, set `dataset` to a file in Assets/StreamingAssets, and set
// `tool` to an object that a script or you move in the Scene view. One unit of Unity is a metre: leave the scale of the organ at 1,
// and scale the other objects.
using System.IO;
using UnityEngine;

namespace PalpateClient {

/// Substitute for a device: the tool follows an object of the scene, which cannot render a force. For a real device, implement
/// IHapticDevice with its library, and send it the force in Write().
public sealed class ToolObject : IHapticDevice {
  private readonly object gate = new object();
  private Vector3d position, force;
  private bool moved;

  public bool Lost => false;
  public bool Read(out Vector3d now) {
    lock (gate) {
      now = position;
      return moved;
    }
  }
  public void Write(Vector3d limited) { lock (gate) force = limited; }
  /// Moves the tool to `place`, in the organ's frame in Unity. Call it from Update().
  public void MoveTo(Vector3 place) {
    lock (gate) {
      position = Vector3d.FromUnity(place);
      moved = true;
    }
  }
  public Vector3 Force { get { lock (gate) return force.ToUnity(); } }
}

[RequireComponent(typeof(MeshFilter))]
public sealed class PalpateOrgan : MonoBehaviour {
  public string dataset = "liver-surface.h5";
  public string profile = "touch";  // device profile: largest force and stiffness
  public Transform tool;

  private ToolObject hand;
  private HapticLoop loop;
  private Mesh mesh;
  private Vector3[] atRest, shape;
  private float[] displacements;

  /// Force on the tool, N, in Unity's world frame.
  public Vector3 Force => transform.TransformDirection(hand.Force);

  // Loading takes seconds. If the scene must not stop, open the dataset on another thread beforehand.
  private void OnEnable() {
    hand = new ToolObject();
    loop = new HapticLoop(Path.Combine(Application.streamingAssetsPath, dataset), hand, profile);
    atRest = loop.Dataset.UnityVertices();
    shape = (Vector3[])atRest.Clone();
    displacements = new float[3 * atRest.Length];
    mesh = new Mesh { vertices = atRest, triangles = loop.Dataset.UnityTriangles() };
    mesh.MarkDynamic();
    mesh.RecalculateNormals();
    GetComponent<MeshFilter>().mesh = mesh;
  }

  private void Update() {
    if (tool != null) hand.MoveTo(transform.InverseTransformPoint(tool.position));
    loop.Deform(displacements);
    for (int n = 0; n < shape.Length; ++n)
      shape[n] = atRest[n] + new Vector3(displacements[3 * n], displacements[3 * n + 1], -displacements[3 * n + 2]);
    mesh.vertices = shape;
    mesh.RecalculateNormals();
    mesh.RecalculateBounds();
  }

  private void OnDisable() { loop.Dispose(); }
}

}  // namespace PalpateClient
